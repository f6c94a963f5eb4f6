/// Contacts that are hard to resolve, in a space: particles smaller than the rounding of their coordinates, walls that
/// are moved into resting balls, balls that friction holds, divided planes, narrow grooves, displacements lost to
/// rounding. Instantiated by test_hard_contacts*.cpp.
#pragma once

#include <collide/effects/friction.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/lost_motion.hpp>
#include <collide/effects/spin.hpp>

#include "simulation/simulation.hpp"

namespace tests {

/// How many components `axis` of positions are below `least` or above `most`.
template <class S>
std::size_t beyond(std::vector<S> const& x, std::size_t axis, S least, S most) {
  std::size_t n = 0;
  for (std::size_t i = axis; i < x.size(); i += 3) n += x[i] < least || x[i] > most;
  return n;
}

/// Radii, in units in the last place of the coordinates.
inline constexpr double small_radii[] = {1e-30, 0.25, 0.5, 0.75, 1};

/// Particles that are smaller than the rounding of their coordinates fall on a plane, of either winding.
template <class S, class Space>
void check_small_particles_on_plane(Space const& space, std::size_t n) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi_swept<>, S>, collide::bounce>;
  for (double height : {1., 10., 100., 1e4})
    for (bool const flipped : {false, true})
      for (double const ulps : small_radii) {
        CAPTURE(height);
        CAPTURE(flipped);
        CAPTURE(ulps);
        S const h = static_cast<S>(height);
        world<S> w;
        w.radius = static_cast<S>(ulps * (double(std::nextafter(h, S(1e9))) - double(h)));
        if (flipped) {
          w.triangle({-9, -9, double(h), 0, 9, double(h), 9, -9, double(h)});
        } else {
          w.triangle({-9, -9, double(h), 9, -9, double(h), 0, 9, double(h)});
        }
        std::mt19937 engine(1);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (std::size_t i = 0; i < n; ++i)
          w.particle(uniform(engine), uniform(engine), height + 0.05 * (1.5 + uniform(engine)), uniform(engine),
                     uniform(engine), -5 - uniform(engine));
        running<simulation> made(space, w, collide::bounce{0.5});
        made.simulation.steps(8, S(0.01));
        auto const x = made.positions(), v = made.velocities();
        CHECK(beyond(x, 2, h, std::numeric_limits<S>::max()) == 0);
        CHECK(beyond(v, 2, S(0), S(9)) == 0);
      }
}

/// The same in closed boxes, with all their edges and corners.
template <class S, class Space>
void check_small_particles_in_box(Space const& space, std::size_t n, std::size_t steps) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi_swept<>, S>, collide::bounce>;
  for (double const restitution : {0., 0.5, 1.})
    for (double const ulps : small_radii) {
      CAPTURE(restitution);
      CAPTURE(ulps);
      world<S> w;
      w.radius = static_cast<S>(ulps) * std::numeric_limits<S>::epsilon();
      add_cube(w, 1, 3);
      std::mt19937 engine(5);
      std::uniform_real_distribution<double> uniform(-1, 1);
      for (std::size_t i = 0; i < n; ++i) {
        double at[3], to[3];  // some fly exactly into a corner, some into an edge
        for (int k = 0; k < 3; ++k) at[k] = 0.9 * uniform(engine), to[k] = 300 * uniform(engine);
        for (std::size_t k = 0; k < i % 4; ++k) to[k] = 64 * ((i >> (2 + k) & 1) != 0 ? 1 - at[k] : -1 - at[k]);
        w.particle(at[0], at[1], at[2], to[0], to[1], to[2]);
      }
      running<simulation> made(space, w, collide::bounce{restitution});
      made.simulation.steps(steps, S(1) / 64);
      for (std::size_t axis = 0; axis < 3; ++axis) CHECK(beyond(made.positions(), axis, S(-1), S(1)) == 0);
    }
}

/// A wall that `set_mesh` moves by less than a radius a step pushes resting balls before it, and loses none.
template <class NarrowPhase, class S, class Space>
void check_moving_wall(Space const& space, std::size_t n) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, collide::gravity, collide::bounce>;
  double const r = 0.1;
  for (double const pace : {0.003, 0.1, 0.9}) {  // radii a step
    CAPTURE(pace);
    world<S> w;
    w.radius = static_cast<S>(r);
    std::mt19937 engine(4);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (std::size_t i = 0; i < n; ++i) w.particle(0.4 + uniform(engine), -0.9 + 1.8 * uniform(engine), r);
    running<simulation> made(space, w, collide::gravity{}, collide::bounce{0.5});
    double x = 0;
    std::size_t const steps = static_cast<std::size_t>(std::min(100., 2 / (pace * r)));
    for (std::size_t i = 0; i < steps; ++i) {
      x += pace * r;
      world<S> mesh;
      add_floor(mesh, 6, 12);
      mesh.triangle({x, -1, -1, x, 1, -1, x, 1, 1});
      mesh.triangle({x, -1, -1, x, 1, 1, x, -1, 1});
      placed<S> const corners(space, mesh.corners);
      made.simulation.set_mesh(collide::triangle_soup(corners.data(), corners.size() / 9));
      made.simulation.step(S(1e-3));
      made.simulation.space().synchronize();
    }
    auto const at = made.positions();
    CHECK(beyond(at, 0, static_cast<S>(x), S(100)) == 0);
    CHECK(beyond(at, 2, static_cast<S>(0.99 * r), static_cast<S>(1.01 * r)) == 0);
  }
}

/// A particle that friction holds on a slope, with rolling resistance where it can roll, stays where it is.
template <class NarrowPhase, class S, class Space, class... Effect>
void check_held(Space const& space, std::size_t steps, Effect const&... effects) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, Effect...>;
  double const r = 0.1;
  for (double const degrees : {2., 10., 25.})
    for (double const dt : {2e-3, 1e-4}) {
      CAPTURE(degrees);
      CAPTURE(dt);
      double const a = degrees * 3.14159265358979 / 180, c = std::cos(a), s = std::sin(a);
      world<S> flat, w;
      w.radius = static_cast<S>(r);
      add_floor(flat, 5, 7);
      for (std::size_t i = 0; i < flat.corners.size(); i += 3)
        for (double v : {c * double(flat.corners[i]), double(flat.corners[i + 1]), s * double(flat.corners[i])})
          w.corners.push_back(static_cast<S>(v));
      for (double x : {-0.5, 0.3, 1.1}) w.particle(c * x - s * r, 0.1 * x, s * x + c * r);
      running<simulation> made(space, w, effects...);
      made.simulation.steps(2000, S(dt));
      auto const before = made.positions();
      made.simulation.steps(steps, S(dt));
      auto const after = made.positions(), v = made.velocities();
      for (std::size_t i = 0; i < after.size(); ++i) {
        CHECK(std::abs(double(after[i]) - double(before[i])) <= 1e-5 * r);
        CHECK(v[i] == 0);
      }
    }
}

/// Balls that drop straight on a level floor, however it is divided into triangles, keep their direction.
template <class NarrowPhase, class S, class Space>
void check_straight_drop(Space const& space, std::size_t n) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, collide::gravity, collide::bounce>;
  double const r = 0.2;
  for (int const cells : {7, 160}) {
    CAPTURE(cells);
    world<S> w;
    w.radius = static_cast<S>(r);
    add_floor(w, 4, cells);
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> uniform(-3.7, 3.7);
    for (std::size_t i = 0; i < n; ++i) w.particle(uniform(engine), uniform(engine), r + 0.01, 0, 0, -40);
    running<simulation> made(space, w, collide::gravity{}, collide::bounce{0.5});
    made.simulation.steps(20, S(2e-3));
    auto const v = made.velocities();
    double const most = 20 * (sizeof(S) == 4 ? 1e-6 : 1e-12);
    std::size_t deflected = 0, bounced = 0;
    for (std::size_t i = 0; i < v.size(); i += 3) {
      bounced += v[i + 2] > 0;
      deflected += std::hypot(double(v[i]), double(v[i + 1])) > most;
    }
    CHECK(bounced == n);
    CHECK(deflected == 0);
  }
}

/// A ball that falls into a groove comes to rest where it touches both walls. It gains no energy on the way.
template <class NarrowPhase, class S, class Space>
void check_groove(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, collide::gravity, collide::bounce>;
  double const r = 0.1, g = 9.81;
  for (double const degrees : {3., 10., 45.})
    for (double const restitution : {0., 0.5})
      for (double const dt : {1e-3, 1e-2}) {
        CAPTURE(degrees);
        CAPTURE(restitution);
        CAPTURE(dt);
        double const a = degrees * 3.14159265358979 / 180, x = 6 * std::sin(a), z = 6 * std::cos(a),
                     rest = r / std::sin(a);
        world<S> w;
        w.radius = static_cast<S>(r);
        for (double side : {-1., 1.}) {
          w.triangle({0, -1, 0, 0, 1, 0, side * x, 1, z});
          w.triangle({0, -1, 0, side * x, 1, z, side * x, -1, z});
        }
        w.particle(0.003, 0.1, rest + 0.05);
        running<simulation> made(space, w, collide::gravity{}, collide::bounce{restitution});
        double most = 0;
        for (int i = 0; i < 20; ++i) {
          made.simulation.steps(dt < 5e-3 ? 200 : 50, S(dt));
          auto const v = made.velocities();
          double energy = g * (double(made.positions()[2]) - rest);
          for (S u : v) energy += double(u) * double(u) / 2;
          most = std::max(most, energy);
        }
        auto const at = made.positions(), v = made.velocities();
        CHECK(most <= g * 0.05 * 1.05 + g * dt * g * dt);
        CHECK(std::abs(double(at[2]) - rest) * std::sin(a) <= 0.01 * r);
        CHECK(std::abs(double(at[0])) <= 0.01 * r);
        for (S u : v) CHECK(std::abs(double(u)) <= 1e-4 * g * dt);
      }
}

/// Particles whose displacement is lost to rounding are counted, and no others.
template <class S, class Space>
void check_lost_motion(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::gravity, collide::lost_motion>;
  world<S> w;
  w.radius = S(0.1);
  double const ulp = double(std::numeric_limits<S>::epsilon());
  S const dt = sizeof(S) == 4 ? S(1e-6) : S(1e-9);
  w.particle(0, 0, 64);                                      // falls, and does not get away from 64
  w.particle(0, 0, 0);                                       // falls from where numbers are small
  w.particle(0, 0, 64, 64 * ulp / double(dt), 0, 0);         // gets on along x
  w.particle(64, 0, 64, 0.4 * 64 * ulp / double(dt), 0, 0);  // does not
  running<simulation> made(space, w, collide::gravity{}, collide::lost_motion{});
  made.simulation.steps(3, dt);
  auto const lost = made.simulation.template to_host<collide::lost_steps>();
  CHECK((lost == std::vector<std::uint32_t>{3, 0, 0, 3}));
  CHECK(collide::lost_particles(made.simulation) == 2);
}

// ---- what is run where

template <class S, class Space>
void check_small_particles(Space const& space, std::size_t n) {
  check_small_particles_on_plane<S>(space, n);
  check_small_particles_in_box<S>(space, n, 40);
}

template <class S, class Space>
void check_held_in_any_order(Space const& space, std::size_t steps) {
  collide::gravity const gravity;
  collide::bounce const bounce{0.3};
  collide::friction const friction{0.6, 0.6};
  collide::spin const spin{0.5};
  using collide::karabassi;
  check_held<karabassi<>, S>(space, steps / 10, gravity, bounce, friction);
  check_held<karabassi<>, S>(space, steps, gravity, bounce, friction, spin);
  check_held<karabassi<>, S>(space, steps / 10, gravity, bounce, spin, friction);
  check_held<karabassi<>, S>(space, steps / 10, collide::velocity_verlet{}, gravity, bounce, friction, spin);
  check_held<collide::karabassi_swept<>, S>(space, steps / 10, gravity, bounce, friction, spin);
}

template <class NarrowPhase, class S, class Space>
void check_walls(Space const& space, std::size_t n) {
  check_moving_wall<NarrowPhase, S>(space, n);
  check_straight_drop<NarrowPhase, S>(space, n);
  check_groove<NarrowPhase, S>(space);
}

}  // namespace tests
