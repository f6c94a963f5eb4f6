/// Effects on the host.
#include "compositions.hpp"
#include "simulation/effects.hpp"
#include "simulation/neighbours.hpp"

using collide::host;
using collide::karabassi;
using collide::karabassi_swept;
using tests::lockstep;

namespace {

/// Does what is to be done in any order in the reverse order.
class reversed : public host {
 public:
  using host::host;

  template <class F>
  void for_each(std::size_t n, F const& f) const {
    for (std::size_t i = n; i-- > 0;) f(i);
  }
};

template <class F>
constexpr bool is_rebuild = false;
template <class S, class Scene>
constexpr bool is_rebuild<collide::detail::build_lists<S, Scene>> = true;

/// Counts how often neighbour lists are made.
class counting_space : public host {
 public:
  using host::host;
  static inline int done = 0;

  template <class F>
  void for_each(std::size_t n, F const& f) const {
    done += is_rebuild<F>;
    host::for_each(n, f);
  }
};

}  // namespace

TEST_CASE("effects: drag leads to the terminal velocity, as the closed form has it") { tests::check_drag(host(1)); }

TEST_CASE("effects: drag and wind give the same bits as blocks of threads go") {
  using blocks = tests::lockstep<64, true>;
  for (double const strength : {0., 0.1, 10., 1e3}) {
    CHECK(tests::fallen_in_media<float, collide::semi_implicit_euler>(host(1), strength) ==
          tests::fallen_in_media<float, collide::semi_implicit_euler>(blocks(), strength));
    CHECK(tests::fallen_in_media<double, collide::velocity_verlet>(host(1), strength) ==
          tests::fallen_in_media<double, collide::velocity_verlet>(blocks(), strength));
  }
}

TEST_CASE("effects: wind, uniform and a user's field") { tests::check_wind(host(1)); }

TEST_CASE("effects: what is on an incline slides if and only if it is steeper than friction holds") {
  tests::check_incline<karabassi<>>(host(2));
  tests::check_incline<karabassi_swept<>>(host(2));
}

TEST_CASE("effects: sliding becomes rolling at 5/7 of the speed") {
  tests::check_rolling<karabassi<>>(host(1));
  tests::check_rolling<karabassi_swept<>>(host(1));
}

TEST_CASE_TEMPLATE("effects: spheres that meet conserve momentum, and energy if e = 1", S, float, double) {
  tests::check_collisions<S>(host(1));
}

TEST_CASE("effects: a pile of spheres stays in a closed mesh for 2e4 steps") { tests::check_pile(host(1), 20000, 200); }

TEST_CASE("hunt: effects: a pile of spheres stays in a closed mesh for 1e5 steps") {
  tests::check_pile(host(1), 100000, 200);
}

TEST_CASE("effects: spheres that meet do so in the same bits on every run") {
  tests::check_meeting_determinism(host(1), host(2));
  tests::check_meeting_determinism(host(1), lockstep<256, true>());
  tests::check_meeting_determinism(host(1), reversed());
}

TEST_CASE("effects: small particles are listed apart where larger ones are few") {
  using range = collide::detail::radius_range<double>;
  CHECK(range{0.01, 0.2, 0.015, 20}.has_small_apart(20000, 0.002));
  CHECK(range{0.01, 0.05, 0.02, 2000}.has_small_apart(20000, 0.002));
  CHECK_FALSE(range{0.01, 1, 0.01, 99999}.has_small_apart(100000, 0.002));  // a grain of dust among others
  CHECK_FALSE(range{0.01, 0.02, 0.02, 0}.has_small_apart(100, 0.002));
  CHECK_FALSE(range{0.01, 1, 0, 0}.has_small_apart(100, 0.002));  // not known
  CHECK(range{0.01, 0.2, 0.015, 20}.with(0.018).small == 0.018);
  for (double const of_source : {0.005, 0.05}) CHECK(range{0.01, 0.2, 0.015, 20}.with(of_source).small == 0);
}

TEST_CASE_TEMPLATE("effects: particles meet those that they overlap, in the order of their numbers", S, float, double) {
  tests::check_neighbours<S>(host(1));
}

TEST_CASE("effects: particles meet those that they overlap, whoever is first") {
  tests::check_neighbours<float>(host(2));
  tests::check_neighbours<float>(reversed());
}

TEST_CASE("effects: neighbour lists are kept while nothing has come or moved far") {
  using namespace tests;
  using simulation = collide::simulation<meets_mesh<counting_space>, ghosts, greets>;
  auto w = packed_cube<float>(700, 0.1, 0.00001);
  running<simulation> made(counting_space(1), w, ghosts{}, greets{});
  for (std::size_t i = 600; i < 700; ++i) write_particle<alive>(made.simulation, i, {std::uint8_t(0)});
  auto const after = [&](std::size_t steps) {
    counting_space::done = 0;
    made.simulation.steps(steps, 1);
    return counting_space::done;
  };
  int const made_anew = 1;
  CHECK(after(1) == made_anew);
  CHECK(after(40) == 0);
  write_particle<alive>(made.simulation, 3, {std::uint8_t(0)});
  CHECK(after(1) == 0);  // what has gone is left out
  write_particle<alive>(made.simulation, 650, {std::uint8_t(1)});
  CHECK(after(1) == made_anew);
  write_particle<position>(made.simulation, 5, {0.0f, 0.0f, 0.0f});
  CHECK(after(1) == made_anew);
  CHECK(after(40) == 0);
}

TEST_CASE("effects: what rests sleeps until it is hit") {
  tests::check_sleep(host(1));
  tests::check_sleep_in_a_row(host(1));
}

TEST_CASE("effects: what sticks stays until it is pulled off") {
  tests::check_stick<karabassi<>>(host(1));
  tests::check_stick<karabassi_swept<>>(host(1));
}

TEST_CASE("effects: boxes with walls and boxes that repeat") { tests::check_bounds(host(1)); }

TEST_CASE("effects: particles vanish in sinks") {
  tests::check_absorb<karabassi<>>(host(1));
  tests::check_absorb<karabassi_swept<>>(lockstep<64, true>());
}

TEST_CASE("effects: particles come out of sources") { tests::check_emit(host(1)); }

TEST_CASE_TEMPLATE("effects: a source keeps the number of its particles when its rate changes", S, float, double) {
  tests::check_rates<S>(host(1));
  tests::check_rates<S>(reversed());
  tests::check_rates<S>(lockstep<64, true>());
}

TEST_CASE("effects: the radius of what comes out of a source") {
  tests::check_source_radius(host(1));
  tests::check_source_radius(lockstep<64, true>());
}
