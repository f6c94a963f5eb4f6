/// Meshes that move on ranks, on the host: where nobody is, where they deform, and where they are free.
#include <cmath>
#include <sstream>

#include <collide/ranks/distributed_checkpoint.hpp>
#include <collide/ranks/thread_ranks.hpp>

#include "ranks/simulations.hpp"

namespace {

using collide::thread_ranks;

/// Calls f(ranks, complaints) on `n` threads, and fails with what they complain about.
template <class F>
void on_threads(int n, F const& f) {
  CAPTURE(n);
  std::vector<tests::complaints> wrong(static_cast<std::size_t>(n));
  thread_ranks::run(n, [&](thread_ranks const& ranks) { f(ranks, wrong[static_cast<std::size_t>(ranks.rank())]); });
  for (auto const& w : wrong) CHECK(w.text() == "");
}

template <class Simulation>
std::vector<collide::body_state> poses_of(Simulation const& of) {
  return of.bodies().to_host(of.space());
}

using scene =
    collide::simulation<tests::discrete<collide::host>, collide::sphere_contact, collide::gravity, collide::bounce,
                        collide::friction, collide::reaction, collide::moving_bodies<collide::driven>>;
constexpr float dt = 2e-3f;
constexpr double density = 1000;

/// Grains in a box, on a plate (triangles 0 and 1) above a floor.
tests::world<float> grains() {
  auto w = tests::packed_cube<float>(200, 0.06, 0.4);
  for (double const z : {-0.5, -1.0}) tests::add_floor(w, 1.2, 1, z);
  for (double const x : {-1.1, 1.1}) {
    w.triangle({x, -3, -3, x, 3, -3, x, 0, 9});
    w.triangle({-3, x, -3, 3, x, -3, 0, x, 9});
  }
  return w;
}

/// Sums over bodies and over triangles, on one rank and on many.
struct given {
  std::vector<collide::body_impulse> bodies, triangles;
};
given given_to(scene const& one, collide::reaction_sums const& sums) {
  return {sums.read(one.space()), sums.read_triangles(one.space())};
}
template <class Ranks>
given given_to(collide::distributed<scene, Ranks> const& parts, collide::reaction_sums const& sums) {
  return {parts.total(sums), parts.total_of_triangles(sums)};
}
scene const& local(scene const& one) { return one; }
template <class Ranks>
auto const& local(collide::distributed<scene, Ranks> const& parts) {
  return parts.local();
}

/// The grains with a mesh that somebody moves.
class play {
 public:
  explicit play(bool deforms) : deforms_{deforms} {}

  collide::reaction_sums const& sums() const { return sums_; }
  tests::world<float> const& world() const { return w_; }

  /// A simulation of it; `first` are the arguments before effects.
  template <class Made, class... First>
  Made made(First const&... first) {
    return Made(first..., cpu_, collide::sphere_contact::from_restitution(0.4, 0.02, 0.06, density, 0.5),
                collide::gravity{}, collide::bounce{0.3}, collide::friction{0.3, 0.3}, sums_.effect(density),
                collide::moving_bodies<collide::driven>{});
  }
  template <class Made>
  void begin(Made& of, tests::range own) {
    set_mesh(of);
    there_.set(of, own);
  }
  template <class Made>
  void set_mesh(Made& of) {
    if (deforms_) return deform(of, 0);
    of.set_mesh(collide::triangle_soup(corners_.data(), corners_.size() / 9), {{0, 2, {}}});
  }
  /// Steps from one number to before another. Where the plate is free it hangs on a spring.
  template <class Made>
  void run(Made& of, int from, int to) {
    sums_.clear(cpu_);
    for (int k = from; k < to; ++k) {
      if (deforms_) deform(of, k);
      if (!deforms_) sums_.clear(cpu_);
      of.step(dt);
      last_ = given_to(of, sums_);
      if (!deforms_) move(local(of));
    }
  }
  given const& last() const { return last_; }
  double height = 0, speed = 0;  ///< of the plate, if it is free

 private:
  /// The plate is a wave, with the velocities that belong to it.
  template <class Made>
  void deform(Made& of, int k) {
    velocities_.assign(corners_.size(), 0);
    for (std::size_t i = 2; i < 36; i += 3) {
      double const phase = 3 * double(w_.corners[i - 2]) + 8 * k * double(dt);
      corners_[i] = float(-0.5 + 0.1 * std::sin(phase));
      velocities_[i] = float(0.8 * std::cos(phase));
    }
    of.set_mesh(collide::triangle_soup(corners_.data(), corners_.size() / 9), {}, velocities_.data());
  }
  template <class Part>
  void move(Part const& part) {
    double const force = last_.bodies[0].linear[2] / double(dt);
    speed += double(dt) * (force - 500 * height - 20 * speed) / 30;
    height += double(dt) * speed;
    collide::body_state& state = part.bodies().states()[0];
    state.at.position[2] = height;
    state.moving.linear[2] = speed;
  }

  bool deforms_;
  collide::host cpu_{1};
  tests::world<float> w_ = grains();
  tests::world_in<collide::host, float> there_{cpu_, w_};
  std::vector<float> corners_ = w_.corners, velocities_;
  collide::reaction_sums sums_{cpu_, 1, 1e-12, 4};
  given last_;
};

void expect_same(given const& found, given const& expected, tests::complaints& wrong) {
  wrong.expect(tests::equal_bytes(found.bodies, expected.bodies), "what bodies have got");
  wrong.expect(tests::equal_bytes(found.triangles, expected.triangles), "what triangles have got");
}

/// The grains on `n` ranks, saved in the middle, and loaded on `m`: the bits of one simulation.
void check_play(bool deforms, int n, int m) {
  constexpr int half = 60;
  play expected(deforms);
  auto one = expected.made<scene>();
  expected.begin(one, {0, expected.world().size()});
  expected.run(one, 0, half);
  given const middle = expected.last();
  double const height = expected.height, speed = expected.speed;
  expected.run(one, half, 2 * half);
  if (deforms) {
    CHECK(middle.bodies[1].linear[2] < 0);
    CHECK(middle.triangles[0].linear[2] + middle.triangles[1].linear[2] < 0);
  } else {
    CHECK(height < 0);
    CHECK(expected.height < height);
  }
  tests::values_of<scene> values;
  values.read(one);
  using parts_type = collide::distributed<scene, thread_ranks>;
  std::ostringstream saved;
  on_threads(n, [&](thread_ranks const& ranks, tests::complaints& wrong) {
    play mine(deforms);
    auto parts = mine.made<parts_type>(ranks);
    mine.begin(parts, tests::part_of(mine.world().size(), tests::split::odd, ranks.rank(), n));
    mine.run(parts, 0, half);
    expect_same(mine.last(), middle, wrong);
    wrong.expect(mine.height == height, "the plate is where it was on one rank");
    wrong.expect(parts.total_refused(mine.sums()) == 0, "all contacts are in the sums");
    collide::save(parts, saved);
  });
  on_threads(m, [&](thread_ranks const& ranks, tests::complaints& wrong) {
    play mine(deforms);
    auto parts = mine.made<parts_type>(ranks);
    mine.set_mesh(parts);
    std::istringstream from(saved.str());
    collide::load(parts, from);
    mine.height = height, mine.speed = speed;
    mine.run(parts, half, 2 * half);
    expect_same(mine.last(), expected.last(), wrong);
    wrong.expect(mine.height == expected.height, "the plate is where it is on one rank");
    auto const own = tests::part_of(mine.world().size(), tests::split::evenly, ranks.rank(), m);
    tests::values_of<scene> found;
    found.read(parts);
    wrong.expect(equal(found, values.part(own.first, own.size)), "grains, after a checkpoint");
  });
}

}  // namespace

TEST_CASE("bodies on ranks: time and bodies go on where nobody is") {
  using empty = collide::simulation<tests::discrete<collide::host>, collide::bounce, collide::moving_bodies<>>;
  float const plate[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0};
  collide::body body{0, 1, {}};
  body.motion.velocity[0] = 3;
  body.motion.rate = 0.2;
  collide::host const cpu(1);
  auto const step = [&](auto& s, std::size_t particles) {
    float const centre[] = {5, 5, 5};
    s.set_mesh(collide::triangle_soup(plate, 1), {body});
    s.set(collide::spheres_xyz(centre, particles, 0.1f));
    s.steps(9, 0.25f);
  };
  empty one(cpu, collide::bounce{}, collide::moving_bodies<>{}),
      seen(cpu, collide::bounce{}, collide::moving_bodies<>{});
  step(one, 0);
  step(seen, 1);
  CHECK(one.time() == 2.25);
  CHECK(double(poses_of(one)[0].at.position[0]) == doctest::Approx(3 * 2.25));
  CHECK(tests::equal_bytes(poses_of(one), poses_of(seen)));
  for (int const n : {1, 2, 3, 7}) {
    on_threads(n, [&](thread_ranks const& ranks, tests::complaints& wrong) {
      for (int const with : {n, 1}) {  // none at all, or one on rank 1, if there is one
        collide::distributed<empty, thread_ranks> parts(ranks, cpu, collide::bounce{}, collide::moving_bodies<>{});
        step(parts, ranks.rank() == with ? 1 : 0);
        wrong.expect(parts.time() == one.time(), "time goes on");
        wrong.expect(tests::equal_bytes(poses_of(parts.local()), poses_of(one)), "bodies go on");
      }
    });
  }
}

TEST_CASE("bodies on ranks: a mesh that deforms, what its triangles get, and its checkpoints") {
  check_play(true, 1, 3);
  check_play(true, 3, 2);
}

TEST_CASE("bodies on ranks: a body that is free, what it gets, and its checkpoints") {
  check_play(false, 2, 7);
  check_play(false, 7, 1);
}

TEST_CASE("bodies on ranks: sums that do not fit are errors on all ranks") {
  std::int64_t const large = std::int64_t{1} << 62;
  for (int const n : {1, 2, 3}) {
    on_threads(n, [&](thread_ranks const& ranks, tests::complaints& wrong) {
      std::string said;
      std::vector<std::int64_t> const mine{-large / n, large, -1, 7 + ranks.rank()};
      try {
        auto const all = collide::detail::rank_reduction(ranks, [&] { return mine; });
        wrong.expect(n == 1 && all == mine, "two of these are too large");
      } catch (collide::error const& e) {
        said = e.what();
      }
      wrong.expect(said.empty() == (n == 1), said);
      std::vector<std::int64_t> const fits{-large / n, large / n, -1, 7 + ranks.rank()};
      auto const all = collide::detail::rank_reduction(ranks, [&] { return fits; });
      wrong.expect(all == std::vector<std::int64_t>{-large / n * n, large / n * n, -n, 7 * n + n * (n - 1) / 2},
                   "sums, also of negative numbers");
    });
  }
}
