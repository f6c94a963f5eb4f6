/// Simulations on the host.
#include <algorithm>
#include <vector>

#include <collide/effects/absorb.hpp>

#include "compositions.hpp"
#include "simulation/contact_forces.hpp"
#include "simulation/memory.hpp"
#include "simulation/simulation.hpp"

namespace {

using collide::bounce;
using collide::columns;
using collide::detector;
using collide::gravity;
using collide::host;
using collide::karabassi;
using collide::karabassi_swept;
using collide::simulation;
using collide::velocity_verlet;

using plain = detector<collide::bucket>;
static_assert(std::is_same<simulation<plain>::columns, columns<collide::position, collide::velocity>>::value,
              "a simulation without effects holds positions and velocities");
static_assert(std::is_same<simulation<plain, gravity, bounce>::columns, simulation<plain>::columns>::value,
              "gravity and bounce need no more");
static_assert(simulation<plain>::bytes_per_particle == 24, "six floats");
static_assert(simulation<plain, velocity_verlet, gravity>::bytes_per_particle == 24, "no memory for accelerations");
static_assert(simulation<detector<collide::bucket, karabassi<>, host, double>>::bytes_per_particle == 48,
              "six doubles");

/// A narrow phase of a user's: counts how often it is asked.
struct asked : karabassi_swept<> {
  static inline int times = 0;
  template <class S>
  static S time_of_impact(collide::triangle<S> const& t, collide::moving_sphere<S> const& s) {
    ++times;
    return karabassi_swept<>::time_of_impact(t, s);
  }
};

/// An effect of a user's: writes down which particles it meets.
struct visited {
  using writes = columns<collide::velocity>;
  std::vector<collide::id>* numbers;
  template <class Particle, class S>
  void accelerate(Particle& p, S) const {
    numbers->push_back(p.number());
  }
};

}  // namespace

TEST_CASE_TEMPLATE("simulation: free flight follows the closed form", S, float, double) {
  tests::check_free_flight<S>(host(2));
  tests::check_free_flight<S>(tests::lockstep<256, false>());
}

TEST_CASE("simulation: every step on the host goes forwards through memory, which is read ahead") {
  tests::world<float> w;
  for (int i = 0; i < 256; ++i) w.particle(i, 0, 0);
  std::vector<collide::id> numbers;
  tests::running<simulation<plain, visited>> made(host(1), w, visited{&numbers});
  for (int step = 0; step < 2; ++step) {
    numbers.clear();
    made.simulation.step(1);
    CHECK(numbers.size() == 256);
    CHECK(std::is_sorted(numbers.begin(), numbers.end()));
  }
}

TEST_CASE("simulation: bounces are e^(2n) as high, and end in rest") {
  tests::check_bounces<simulation<plain, gravity, bounce>>(host(1));
  tests::check_bounces<simulation<plain, velocity_verlet, gravity, bounce>>(host(1));
  tests::check_bounces<simulation<detector<collide::bucket, karabassi_swept<>>, gravity, bounce>>(host(1));
  tests::check_bounces<simulation<detector<collide::bucket, karabassi_swept<>>, velocity_verlet, gravity, bounce>>(
      host(1));
  tests::check_bounces<simulation<detector<collide::bucket, karabassi<>, host, double>, gravity, bounce>>(host(1));
}

TEST_CASE_TEMPLATE("simulation: a ball feels no bump at the inner edges of a plane", S, float, double) {
  tests::check_inner_edges<karabassi<>, S>(host(1));
  tests::check_inner_edges<karabassi_swept<>, S>(host(1));
}

TEST_CASE_TEMPLATE("simulation: all walls of a corner count", S, float, double) {
  tests::check_corner<karabassi<>, S>(host(1));
  tests::check_corner<karabassi_swept<>, S>(host(1));
}

TEST_CASE_TEMPLATE("simulation: balls that touch hundreds of triangles", S, float, double) {
  tests::check_many_contacts<karabassi<>, S>(host(1));
  tests::check_many_contacts<karabassi<>, S>(tests::lockstep<64, true>());
  tests::check_many_contacts<karabassi_swept<>, S>(host(2));
  tests::check_many_contacts<karabassi_swept<>, S>(tests::lockstep<64, true>());
}

TEST_CASE_TEMPLATE("simulation: balls that just touch, or just do not", S, float, double) {
  tests::check_tangent_balls<S>(host(2));
  tests::check_tangent_balls<S>(tests::lockstep<256, false>());
  tests::check_tangent_balls<S>(tests::lockstep<64, true>());
  tests::check_sunk_balls<karabassi<>, S>(host(1));
  tests::check_sunk_balls<karabassi<>, S>(tests::lockstep<64, true>());
  tests::check_sunk_balls<karabassi<collide::single_precision>, S>(tests::lockstep<64, false>());
}

TEST_CASE("simulation: elastic bounces keep their height, however coarse the step") {
  using swept = detector<collide::bucket, karabassi_swept<>>;
  for (double const dt : {1.0 / 60, 5e-3}) {
    tests::check_coarse_bounces<simulation<plain, gravity, bounce>>(host(1), dt, 0.5);
    tests::check_coarse_bounces<simulation<plain, velocity_verlet, gravity, bounce>>(host(1), dt, 0);
    tests::check_coarse_bounces<simulation<swept, gravity, bounce>>(host(1), dt, 0.5);
    tests::check_coarse_bounces<simulation<swept, velocity_verlet, gravity, bounce>>(host(1), dt, 0);
  }
}

TEST_CASE("simulation: particles stay in a closed mesh for 1e5 steps") {
  tests::check_closed_mesh<karabassi<>, float>(host(1), 100000, 3);
  tests::check_closed_mesh<karabassi_swept<>, float>(host(1), 100000, 3, 8);
}

TEST_CASE("simulation: particles too fast for the discrete test stay in a closed mesh if their way is swept") {
  tests::check_closed_mesh<karabassi_swept<>, float>(host(2), 1000, 2000);
  tests::check_closed_mesh<karabassi_swept<>, double>(host(2), 1000, 2000);
}

TEST_CASE("simulation: the same bits on every run, with any number of threads, in lockstep, with both broad phases") {
  tests::check_determinism<karabassi<>>(host(1), host(2));
  tests::check_determinism<karabassi_swept<>>(host(1), host(2));
  tests::check_determinism<karabassi<>>(host(1), tests::lockstep<256, false>());
  tests::check_determinism<karabassi<>>(host(1), tests::lockstep<64, true>());
  tests::check_determinism<karabassi_swept<>>(host(1), tests::lockstep<64, true>());
}

TEST_CASE("simulation: the same bits where a block has more particles near the mesh than it resolves at a time") {
  tests::lockstep<64, true> const one_block;
  tests::check_crowded_blocks<karabassi<>, float>(one_block, host(2));
  tests::check_crowded_blocks<karabassi<>, double>(tests::lockstep<256, false>(), host(2));
  tests::check_crowded_blocks<karabassi_swept<>, float>(one_block, host(2));
  tests::check_crowded_blocks<karabassi<>, float>(one_block, host(2), collide::absorbing_box{{-1, -1, -1}, {0, 1, 1}});
}

TEST_CASE("simulation: memory is that of the columns, and a step takes none") {
  auto const make = [](std::pmr::memory_resource* from) { return host(1, from); };
  tests::check_memory_of_steps<host>(make, std::pmr::new_delete_resource());
}

TEST_CASE("simulation: an effect of a user, with a column of its own") {
  tests::check_own_effect(host(1));
  tests::check_own_effect(tests::lockstep<64, true>());
}

TEST_CASE("simulation: radii that differ") {
  tests::check_radii(host(1));
  float const centres[] = {0, 0, 0}, radii[] = {1};
  simulation<plain> one_size;
  CHECK_THROWS_AS(one_size.set(collide::spheres_xyz(centres, 1, radii)), collide::error);
  CHECK_THROWS_AS(one_size.set(collide::spheres_xyz(centres, 1, 1.0f), nullptr, 2), collide::error);
}

TEST_CASE("simulation: more particles than there are numbers for them are refused") {
  float const centre[] = {0, 0, 0};
  simulation<plain, collide::absorb> sink;
  CHECK_THROWS_AS(sink.set(collide::spheres_xyz(centre, 1, 1.0f), nullptr, 0xffffffff), collide::error);
  CHECK(sink.size() == 0);
}

TEST_CASE("simulation: a narrow phase of one's own says when its balls stop") {
  asked::times = 0;
  tests::check_corner<asked, double>(host(1));
  CHECK(asked::times > 0);
}

TEST_CASE("simulation: bytes are what it has taken, and once there is room nothing is allocated") {
  tests::check_bytes([](std::pmr::memory_resource* from) { return host(2, from); }, std::pmr::new_delete_resource());
  using steps = tests::lockstep<64, true>;
  tests::check_room<simulation<detector<collide::bucket, karabassi<>, steps>, gravity, bounce>>(
      [](std::pmr::memory_resource* from) { return steps(1, from); }, std::pmr::new_delete_resource());
}

TEST_CASE("simulation: time is the sum of the steps since particles were set") { tests::check_time(host(1)); }

TEST_CASE("simulation: forces of contacts are columns") {
  tests::check_mesh_forces<karabassi<>>(host(1));
  tests::check_mesh_forces<karabassi_swept<>>(host(2));
  tests::check_mesh_forces<karabassi<>>(tests::lockstep<64, true>());
  tests::check_pair_forces<float>(host(1));
  tests::check_pair_forces<double>(tests::lockstep<256, false>());
}

TEST_CASE("simulation: nothing to do") {
  simulation<plain, gravity, bounce> empty;
  empty.set({});
  empty.set_mesh({});
  empty.step(1);
  CHECK(empty.size() == 0);
  CHECK(empty.to_host<collide::position>().empty());
  float const centres[] = {0, 0, 0};
  empty.set(collide::spheres_xyz(centres, 1, 1.0f));
  empty.step(1);
  CHECK(empty.to_host<collide::velocity>()[2] == doctest::Approx(-9.81));
  empty.set_mesh({});
  empty.step(1);
  CHECK(empty.to_host<collide::velocity>()[2] == doctest::Approx(2 * -9.81));
}
