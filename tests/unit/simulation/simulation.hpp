/// Simulations in a space, against closed forms; instantiated by test_simulation.cpp and test_simulation_cuda.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/automatic.cuh>
#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation.cuh>

#include "compared.hpp"
#include "io/counting.hpp"

namespace tests {

using collide::position;
using collide::velocity;

/// Numbers in memory of a space.
template <class T>
class placed {
 public:
  template <class Space>
  placed(Space const& space, std::vector<T> const& from) : size_{from.size()} {
    space.copy_from_host(memory_.reserve(space.resource(), from.size() + 1), from.data(), from.size());
  }
  T const* data() const { return memory_.data(); }
  std::size_t size() const { return size_; }

 private:
  collide::buffer<T> memory_;
  std::size_t size_;
};

/// A mesh as a soup of corners, and particles, on the host.
template <class S>
struct world {
  std::vector<S> corners, centres, velocities;
  S radius = 0;
  std::vector<S> radii;  ///< if they differ

  void triangle(std::initializer_list<double> nine) {
    for (double x : nine) corners.push_back(static_cast<S>(x));
  }
  void particle(double x, double y, double z, double u = 0, double v = 0, double w = 0) {
    for (double c : {x, y, z}) centres.push_back(static_cast<S>(c));
    for (double c : {u, v, w}) velocities.push_back(static_cast<S>(c));
  }
  std::size_t size() const { return centres.size() / 3; }
};

/// A simulation in which the world has been placed, with the memory of the mesh.
template <class Simulation>
class running {
 public:
  using S = typename Simulation::scalar;

  template <class... Effect>
  running(typename Simulation::execution_space space, world<S> const& w, Effect... effects)
      : simulation(space, effects...), corners_(space, w.corners) {
    place(w);
    simulation.set_mesh(collide::triangle_soup(corners_.data(), corners_.size() / 9));
    simulation.space().synchronize();
  }

  /// Puts these particles in place of all that were, with room for `capacity`.
  void place(world<S> const& w, std::size_t capacity = 0) {
    auto const& space = simulation.space();
    placed<S> const centres(space, w.centres), velocities(space, w.velocities), radii(space, w.radii);
    simulation.set(w.radii.empty() ? collide::spheres_xyz(centres.data(), w.size(), w.radius)
                                   : collide::spheres_xyz(centres.data(), w.size(), radii.data()),
                   velocities.data(), capacity);
    space.synchronize();
  }

  std::vector<S> positions() const { return simulation.template to_host<position>(); }
  std::vector<S> velocities() const { return simulation.template to_host<velocity>(); }

  Simulation simulation;

 private:
  placed<S> corners_;
};

template <class Space, class NarrowPhase = collide::karabassi<>, class S = float, class BroadPhase = collide::bucket>
using meets_mesh = collide::detector<BroadPhase, NarrowPhase, Space, S>;

/// The square |x|, |y| <= half at height z, divided into 2 n^2 triangles with corners moved at random within the plane.
template <class S>
void add_floor(world<S>& w, double half, int n, double z = 0) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  double const cell = 2 * half / n;
  std::vector<double> x, y;
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= n; ++k) {
      bool const inner = i > 0 && k > 0 && i < n && k < n;
      x.push_back(-half + cell * (i + (inner ? uniform(engine) : 0)));
      y.push_back(-half + cell * (k + (inner ? uniform(engine) : 0)));
    }
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      auto const a = static_cast<std::size_t>(i * (n + 1) + k), b = a + std::size_t(n) + 1;
      w.triangle({x[a], y[a], z, x[b], y[b], z, x[b + 1], y[b + 1], z});
      w.triangle({x[a], y[a], z, x[b + 1], y[b + 1], z, x[a + 1], y[a + 1], z});
    }
}

/// The cube |x|, |y|, |z| <= half, its sides divided.
template <class S>
void add_cube(world<S>& w, double half, int n) {
  double const cell = 2 * half / n;
  for (int axis = 0; axis < 3; ++axis)
    for (double const side : {-half, half})
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
          double const u[] = {-half + cell * i, -half + cell * (i + 1)},
                       v[] = {-half + cell * k, -half + cell * (k + 1)};
          std::vector<double> corners;
          for (auto [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
            double p[3];
            p[axis] = side, p[(axis + 1) % 3] = u[a], p[(axis + 2) % 3] = v[b];
            corners.insert(corners.end(), p, p + 3);
          }
          for (double c : corners) w.corners.push_back(static_cast<S>(c));
        }
}

// ---- the checks

/// Without effects particles move in straight lines; under gravity as the integrator's closed form has it.
template <class S, class Space>
void check_free_flight(Space const& space) {
  world<S> w;
  for (int i = 0; i < 1027; ++i) w.particle(i, 2 * i, -i, 1, 0.5 * i, -2);
  w.radius = S(0.1);
  int const steps = 64;
  S const dt = S(1) / 128;
  double const t = steps * double(dt), g = -9.81;
  double const rounding = steps * 2048 * double(std::numeric_limits<S>::epsilon());
  auto const check = [&](auto const& made, double acceleration, double lag) {
    auto const x = made.positions(), v = made.velocities();
    REQUIRE(x.size() == w.centres.size());
    bool right = true;
    for (std::size_t i = 0; i < x.size(); ++i) {
      double const a = i % 3 == 2 ? acceleration : 0;
      right = right && std::abs(double(v[i]) - (double(w.velocities[i]) + a * t)) <= rounding;
      double const expected = double(w.centres[i]) + double(w.velocities[i]) * t + a * t * (t + lag) / 2;
      right = right && std::abs(double(x[i]) - expected) <= rounding;
    }
    CHECK(right);
    if (acceleration != 0)
      compared<S>("free flight",
                  lag == 0 ? "z = z0 + v t - g t² / 2 (velocity Verlet)" : "z = z0 + v t - g t (t + dt) / 2 (Euler)",
                  double(x[2]), double(w.centres[2]) + double(w.velocities[2]) * t + acceleration * t * (t + lag) / 2);
  };
  using detector = meets_mesh<Space, collide::karabassi<>, S>;
  running<collide::simulation<detector>> straight(space, w);
  straight.simulation.steps(steps, dt);
  check(straight, 0, 0);
  running<collide::simulation<detector, collide::gravity>> euler(space, w);
  euler.simulation.steps(steps, dt);
  check(euler, g, double(dt));
  running<collide::simulation<detector, collide::velocity_verlet, collide::gravity>> verlet(space, w);
  verlet.simulation.steps(steps, dt);
  check(verlet, g, 0);
}

/// The n-th bounce is e^(2n) as high as the fall, and in the end the ball rests on the floor.
template <class Simulation>
void check_bounces(typename Simulation::execution_space const& space) {
  using S = typename Simulation::scalar;
  double const e = 0.8, height = 1, radius = 0.1;
  world<S> w;
  add_floor(w, 4, 8);
  w.radius = S(radius);
  for (double x : {0.03, 0.91, -1.37}) w.particle(x, 0.2 + x, radius + height);
  auto made = [&] {
    if constexpr (std::is_same<typename Simulation::effects_type::integrator, collide::velocity_verlet>::value) {
      return running<Simulation>(space, w, collide::velocity_verlet{}, collide::gravity{}, collide::bounce{e});
    } else {
      return running<Simulation>(space, w, collide::gravity{}, collide::bounce{e});
    }
  }();
  S const dt = S(1e-4);
  std::vector<double> peaks;
  double before = 2, highest = 0;
  bool rises = false;
  for (int i = 0; i < 3000; ++i) {
    made.simulation.steps(10, dt);
    double const z = double(made.positions()[2]) - radius;
    if (z > before) rises = true;
    if (rises) highest = std::max(highest, z);
    if (rises && z < before - 1e-3) {
      peaks.push_back(highest);
      highest = 0;
      rises = false;
    }
    before = z;
    if (peaks.size() == 5) break;
  }
  REQUIRE(peaks.size() == 5);
  for (int n = 1; n <= 5; ++n) {
    double const peak = peaks[static_cast<std::size_t>(n - 1)], expected = height * std::pow(e, 2 * n);
    CHECK(peak == doctest::Approx(expected).epsilon(0.005));
    compared<S>("heights of five bounces on a floor", "h_n = h e^(2n)", peak, expected);
  }
  made.simulation.steps(40000, dt);
  auto const x = made.positions(), v = made.velocities();
  double const slow = 9.81 * double(dt) * 0.51;  // velocity Verlet: half a step's acceleration
  for (std::size_t i = 0; i < w.size(); ++i) {
    CHECK(double(x[3 * i + 2]) == doctest::Approx(radius).epsilon(1e-5));
    CHECK(std::abs(double(v[3 * i + 2])) <= slow);
    CHECK(x[3 * i] == w.centres[3 * i]);
    CHECK(v[3 * i] == 0);
  }
}

/// A ball that slides on a plane made of triangles feels no bump at inner edges. The plane is tilted, so that its
/// corners lie in it only up to rounding.
template <class NarrowPhase, class S, class Space>
void check_inner_edges(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, collide::gravity, collide::bounce>;
  double const c = std::cos(0.3), s = std::sin(0.3), radius = 0.25;
  auto const turned = [&](double x, double y, double z) {
    return std::array<double, 3>{c * x + s * z, y, c * z - s * x};
  };
  world<S> flat, w;
  add_floor(flat, 8, 40);
  for (std::size_t i = 0; i < flat.corners.size(); i += 3)
    for (double v : turned(double(flat.corners[i]), double(flat.corners[i + 1]), 0))
      w.corners.push_back(static_cast<S>(v));
  w.radius = S(radius);
  for (int i = 0; i < 32; ++i) {
    auto const x = turned(-6, -4 + 0.25 * i, radius), v = turned(2, 0.3 * std::cos(i), 0);
    w.particle(x[0], x[1], x[2], v[0], v[1], v[2]);
  }
  running<simulation> made(space, w, collide::gravity{-9.81 * s, 0, -9.81 * c}, collide::bounce{0.9});
  made.simulation.steps(5000, S(1e-3));
  auto const x = made.positions(), v = made.velocities();
  double const little = sizeof(S) == 4 ? 1e-4 : 1e-9;
  for (std::size_t i = 0; i < w.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(std::abs(double(v[3 * i + k]) - double(w.velocities[3 * i + k])) <= little);
    CHECK(std::abs(double(x[3 * i]) * s + double(x[3 * i + 2]) * c - radius) <= little);
    CHECK(double(x[3 * i]) * c - double(x[3 * i + 2]) * s == doctest::Approx(4).epsilon(1e-4));
  }
}

/// In a corner all three walls count, in the step in which they are met.
template <class NarrowPhase, class S, class Space>
void check_corner(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, collide::bounce>;
  world<S> w;
  add_cube(w, 1, 5);
  w.radius = S(0.25);
  w.particle(-0.73, -0.72, -0.73, -1, -2, -3);
  w.particle(0.73, -0.74, 0.2, 1, -2, 0);
  running<simulation> made(space, w, collide::bounce{0.5});
  made.simulation.step(S(0.05));
  auto const x = made.positions(), v = made.velocities();
  for (std::size_t k = 0; k < 6; ++k) {
    CHECK(double(v[k]) == doctest::Approx(-0.5 * double(w.velocities[k])).epsilon(1e-5));
    if (k != 5) CHECK(std::abs(double(x[k])) < 0.75);
  }
}

/// The same of balls that touch some hundred triangles each, more than a block keeps contacts of.
template <class NarrowPhase, class S, class Space>
void check_many_contacts(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, collide::bounce>;
  world<S> w;
  add_cube(w, 1, 24);
  w.radius = S(0.6);
  for (int i = 0; i < 24; ++i) {
    double const x = i % 2 == 0 ? 1 : -1, y = i / 2 % 2 == 0 ? 1 : -1, z = i / 4 % 2 == 0 ? 1 : -1, apart = 1e-3 * i;
    w.particle(0.37 * x, (0.36 - apart) * y, 0.35 * z, x, 2 * y, 3 * z);
  }
  running<simulation> made(space, w, collide::bounce{0.5});
  made.simulation.step(S(0.1));
  auto const x = made.positions(), v = made.velocities();
  for (std::size_t k = 0; k < v.size(); ++k) {
    CHECK(double(v[k]) == doctest::Approx(-0.5 * double(w.velocities[k])).epsilon(1e-5));
    CHECK(std::abs(double(x[k])) <= 0.4 + 1e-6);
  }
}

/// However coarse the step, elastic bounces keep their height, each of them. `lag` says how many steps old the velocity
/// is: half a one with Euler.
template <class Simulation>
void check_coarse_bounces(typename Simulation::execution_space const& space, double dt, double lag) {
  world<float> w;
  add_floor(w, 8, 8);
  w.radius = 0.1f;
  std::mt19937 engine(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> before;
  for (int i = 0; i < 256; ++i) {
    double const height = 1 + 0.3 * uniform(engine);
    w.particle(7 * uniform(engine), 7 * uniform(engine), 0.1 + height);
    before.push_back(9.81 * height);
  }
  running<Simulation> made(space, w);
  made.simulation.template effect<collide::bounce>().restitution = 1;
  made.simulation.steps(8000, static_cast<float>(dt));
  auto const x = made.positions(), v = made.velocities();
  double most = 0;  // by how much energy is off
  for (std::size_t i = 0; i < w.size(); ++i) {
    double const speed = double(v[3 * i + 2]) - lag * 9.81 * dt;
    double const after = 9.81 * (double(x[3 * i + 2]) - 0.1) + speed * speed / 2;
    most = std::max(most, std::abs(after / before[i] - 1));
  }
  CHECK(most < 1e-3);
}

/// A world of particles at random in a cube.
template <class S>
world<S> crowd(std::size_t n, double half, double radius, double speed, unsigned seed) {
  world<S> w;
  add_cube(w, half, 6);
  w.radius = static_cast<S>(radius);
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double const inside = half - radius;
  for (std::size_t i = 0; i < n; ++i) {
    double r[6];
    for (int k = 5; k >= 0; --k) r[k] = uniform(engine);
    w.particle(inside * r[0], inside * r[1], inside * r[2], speed * r[3], speed * r[4], speed * r[5]);
  }
  return w;
}

/// The farthest that a coordinate is out of the cube in which the balls must stay.
template <class S>
double excess(std::vector<S> const& x, double half, double radius) {
  double worst = -half;
  for (S c : x) worst = std::max(worst, std::abs(double(c)) - (half - radius));
  return worst;
}

/// Particles in a closed mesh stay there.
template <class NarrowPhase, class S, class Space>
void check_closed_mesh(Space const& space, std::size_t steps, double speed, std::size_t n = 64) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, collide::gravity, collide::bounce>;
  auto const w = crowd<S>(n, 1, 0.1, speed, 7);
  running<simulation> made(space, w, collide::gravity{0, 0, -9.81}, collide::bounce{0.95});
  double worst = -1;
  for (int i = 0; i < 10; ++i) {
    made.simulation.steps(steps / 10, S(1e-3));
    worst = std::max(worst, excess(made.positions(), 1, 0.1));
  }
  CHECK(worst <= 1e-5);
}

/// The same bits on every run, with any number of threads, and with each broad phase.
template <class NarrowPhase, class Space, class Other>
void check_determinism(Space const& space, Other const& other) {
  auto const run = [](auto const& there, auto broad) {
    using space_type = std::decay_t<decltype(there)>;
    using simulation = collide::simulation<meets_mesh<space_type, NarrowPhase, float, decltype(broad)>,
                                           collide::gravity, collide::bounce>;
    auto const w = crowd<float>(500, 1, 0.1, 3, 11);
    running<simulation> made(there, w, collide::gravity{}, collide::bounce{0.7});
    made.simulation.steps(300, 4e-3f);
    return std::make_pair(made.positions(), made.velocities());
  };
  auto const first = run(space, collide::bucket());
  CHECK((run(space, collide::bucket()) == first));
  CHECK((run(other, collide::bucket()) == first));
  CHECK((run(space, collide::bvh()) == first));
  CHECK((run(space, collide::automatic()) == first));
  if constexpr (Space::host_accessible) CHECK((run(space, collide::all_pairs()) == first));
}

/// The same bits where blocks have more particles near the mesh than they resolve at a time, as those of `space` have.
template <class NarrowPhase, class S, class Space, class Other, class... Effect>
void check_crowded_blocks(Space const& space, Other const& other, Effect const&... effects) {
  auto const run = [&](auto const& there) {
    using space_type = std::decay_t<decltype(there)>;
    using simulation =
        collide::simulation<meets_mesh<space_type, NarrowPhase, S>, collide::gravity, collide::bounce, Effect...>;
    running<simulation> made(there, crowd<S>(4999, 1, 0.1, 3, 13), collide::gravity{}, collide::bounce{0.7},
                             effects...);
    made.simulation.steps(25, S(4e-3));
    return std::make_pair(made.positions(), made.velocities());
  };
  CHECK((run(space) == run(other)));
}

/// A kernel functor as far as a space asks for blocks.
struct any_body {
  static constexpr int items = 1;
};

/// `set` allocates the columns of the scene and nothing else that grows with the particles but, where threads share a
/// block, the list of those that may touch the mesh; `step` allocates nothing.
template <class Space, class MakeSpace>
void check_memory_of_steps(MakeSpace make, std::pmr::memory_resource* upstream) {
  auto const bytes_of = [&](auto type, std::size_t n) {
    using simulation = typename decltype(type)::type;
    io::counting_resource counting(upstream);
    Space const plain = make(nullptr);
    auto const w = crowd<float>(n, 1, 0.01, 1, 5);
    placed<float> const centres(plain, w.centres), corners(plain, w.corners);
    simulation made(make(&counting));
    made.set(collide::spheres_xyz(centres.data(), n, w.radius));
    std::size_t const bytes = counting.in_use;
    made.set_mesh(collide::triangle_soup(corners.data(), w.corners.size() / 9));
    std::size_t const calls = counting.allocations;
    made.steps(5, 1e-5f);
    made.space().synchronize();
    CHECK(counting.allocations == calls);
    made.set_mesh(collide::triangle_soup(corners.data(), w.corners.size() / 9));
    made.step(1e-5f);
    made.space().synchronize();
    CHECK(counting.allocations == calls);
    return bytes;
  };
  using detector = meets_mesh<Space>;
  using none = std::common_type<collide::simulation<detector>>;
  using falls = std::common_type<collide::simulation<detector, collide::gravity>>;
  using bounces = std::common_type<collide::simulation<detector, collide::gravity, collide::bounce>>;
  using sizes = std::common_type<collide::simulation<detector, collide::polydisperse>>;
  std::size_t const n = 4096;
  CHECK(bytes_of(none{}, n) == 24 * n);
  CHECK(bytes_of(falls{}, n) == 24 * n);
  CHECK(bytes_of(sizes{}, n) == 28 * n);
  constexpr bool shares_blocks = Space::template block<any_body>::num_threads > 1;
  CHECK(bytes_of(bounces{}, n) == 24 * n + (shares_blocks ? 4 * n : 0));
  // for what meets: number, copies, reference, list, and the share of longer lists, and their state; cells of at most
  // four and at least two to a particle, by 65 in 64; on a CPU for each 64 cells where they are along a curve
  using meets = std::common_type<collide::simulation<detector, collide::sphere_contact>>;
  std::size_t const along_curve = collide::detail::works_alone<Space> ? 2 * n / 64 * 4 : 0;
  CHECK(bytes_of(meets{}, n) == 24 * n + (4 + 28 + 12 + 64 + 4) * n + 2 * n * 4 * 65 / 64 + 20 + along_curve);
}

/// A column and an effect of a user: what touches the mesh becomes warm, and cools down.
struct temperature {
  template <class S>
  using value = S;
  template <class S>
  static constexpr S initial = S(20);
};

struct warmth {
  using writes = collide::columns<temperature>;

  double hot = 100, rate = 0.5;

  template <class Particle, class S>
  COLLIDE_HD void on_mesh_contact(Particle& p, collide::mesh_contact<S>&, S) const {
    p[temperature{}] = S(hot);
  }
  template <class Particle, class S>
  COLLIDE_HD void end_step(Particle& p, S dt) const {
    p[temperature{}] -= S(rate) * (p[temperature{}] - S(20)) * dt;
  }
};

template <class Space>
void check_own_effect(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, collide::gravity, collide::bounce, warmth>;
  static_assert(std::is_same<typename simulation::columns, collide::columns<position, velocity, temperature>>::value,
                "the columns are the union of what the effects name");
  static_assert(simulation::bytes_per_particle == 28, "three and three and one floats");
  world<float> w;
  add_floor(w, 4, 8);
  w.radius = 0.1f;
  w.particle(0, 0, 0.1);
  w.particle(1, 1, 3);
  running<simulation> made(space, w, collide::gravity{}, collide::bounce{}, warmth{80, 0.5});
  made.simulation.steps(100, 1e-3f);
  auto const t = made.simulation.template to_host<temperature>();
  CHECK(t[0] == doctest::Approx(80).epsilon(1e-3));
  CHECK(t[1] == 20);
  std::vector<float> const cold = {1, 2};
  made.simulation.template assign<temperature>(placed<float>(space, cold).data());
  CHECK((made.simulation.template to_host<temperature>() == cold));
}

/// Balls that are within a few roundings of touching: effects hear of those that touch in exact arithmetic. Many more
/// verdicts are open at first than a block has room for.
template <class S, class Space>
void check_tangent_balls(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, warmth>;
  using point = collide::vec3<double>;
  world<S> w;
  w.radius = S(0.3);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto const ball = [&](point const& foot, point const& normal) {
    S const ulp = std::numeric_limits<S>::epsilon();
    for (int off = -4; off <= 4; ++off) {
      point const at = foot + normal * (double(w.radius) * (1 + off * double(ulp)));
      w.particle(at.x(), at.y(), at.z());
    }
  };
  for (int i = 0; i < 60; ++i) {
    auto const corner = [&] { return point(9 * uniform(engine), 9 * uniform(engine), 9 * uniform(engine)); };
    point const a = corner(), b = a + corner() / 9, c = a + corner() / 9;
    w.triangle({a.x(), a.y(), a.z(), b.x(), b.y(), b.z(), c.x(), c.y(), c.z()});
    point const normal = collide::detail::cross<double>(b - a, c - a).normalized();
    ball((a + b + c) / 3, normal);
    ball((a + b + c) / 3, -normal);
    ball((a + b) / 2, ((a + b) / 2 - c).normalized());
  }
  constexpr int blades = 300;  // that share an apex
  for (int i = 0; i < blades; ++i) {
    double const from = 2 * 3.14159265358979 * i / blades, to = 2 * 3.14159265358979 * (i + 1) / blades;
    w.triangle(
        {12.1, 0.7, 0.3, 12.1 + std::cos(from), 0.7 + std::sin(from), -1, 12.1 + std::cos(to), 0.7 + std::sin(to), -1});
  }
  ball({12.1, 0.7, 0.3}, {0, 0, 1});
  ball({12.1, 0.7, 0.3}, point(0.1, 0, 1).normalized());

  running<simulation> made(space, w, warmth{80, 0});
  made.simulation.step(S(0.1));
  auto const t = made.simulation.template to_host<temperature>();
  auto const mesh = collide::triangle_soup(w.corners.data(), w.corners.size() / 9);
  std::size_t touching = 0, open = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    collide::sphere<S> const s{{w.centres[3 * i], w.centres[3 * i + 1], w.centres[3 * i + 2]}, w.radius};
    bool touches = false;
    for (std::size_t k = 0; k < mesh.size(); ++k) {
      touches = touches || collide::karabassi<>::intersects(mesh[k], s);
      open += collide::detail::filter_exact(mesh[k], s).verdict == collide::detail::verdict::uncertain;
    }
    touching += touches;
    CHECK(t[i] == S(touches ? 80 : 20));
  }
  CHECK(open > 4000);
  CHECK(touching > w.size() / 4);
  CHECK(touching < w.size() * 3 / 4);
}

/// Balls whose centres lie on the mesh, or next to it, touch it, whatever the precision of the verdict.
template <class NarrowPhase, class S, class Space>
void check_sunk_balls(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, warmth>;
  world<S> w;
  add_floor(w, 4, 8);
  w.radius = S(0.1);
  for (int i = 0; i < 40; ++i) w.particle(0.05 * i, 0.03 * i, i % 4 == 0 ? std::ldexp(1.0, -20 - i) : 0);
  running<simulation> made(space, w, warmth{80, 0});
  made.simulation.step(S(0.1));
  CHECK((made.simulation.template to_host<temperature>() == std::vector<S>(w.size(), S(80))));
}

/// Balls of different sizes rest at different heights.
template <class Space>
void check_radii(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, collide::gravity, collide::bounce, collide::polydisperse>;
  world<float> w;
  add_floor(w, 8, 8);
  for (int i = 0; i < 10; ++i) {
    w.radii.push_back(0.02f * std::exp2(0.5f * static_cast<float>(i)));
    w.particle(-5 + i, 0, 1);
  }
  running<simulation> made(space, w);
  made.simulation.steps(20000, 5e-4f);
  auto const x = made.positions();
  for (std::size_t i = 0; i < w.size(); ++i) CHECK(x[3 * i + 2] == doctest::Approx(w.radii[i]).epsilon(1e-3));
}

}  // namespace tests
