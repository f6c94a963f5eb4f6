/// Checks where two features meet: weights and momentum of what sticks, sleeps or rests, in each integrator;
/// what sleeps on what moves; what other particles pull at. Instantiated by test_where_features_meet.cpp and
/// test_where_features_meet_cuda.cpp.
#pragma once

#include <algorithm>
#include <random>

#include <collide/effects/adhesion.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/contact_forces.hpp>
#include <collide/effects/emit.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/lost.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/simulation/energy.hpp>

#include "simulation/bodies.hpp"

namespace tests {

using collide::adhesion;
using collide::mesh_forces;
using collide::semi_implicit_euler;
using collide::slow_steps;
using collide::sphere_contact;
using collide::velocity_verlet;

constexpr double density_of_grains = 2500;

/// Mass of a sphere of `density_of_grains`.
inline double mass_of_grain(double radius) { return density_of_grains * 4 / 3 * pi * radius * radius * radius; }

/// A floor, and a ball of radius 0.1 that touches it.
template <class S>
world<S> ball_on_floor() {
  world<S> w;
  w.radius = S(0.1);
  add_floor(w, 3, 1);
  w.particle(0, 0, 0.1);
  return w;
}

/// A particle on the mesh presses with its weight, on the mesh as on a body, whatever holds it.
template <class NarrowPhase, class Integrator, class S, class Space, class... Effect>
void check_weight(Space const& space, Effect... effects) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, Integrator, Effect..., mesh_forces,
                                         collide::reaction, moving_bodies<>>;
  auto const w = ball_on_floor<S>();
  double const weight = mass_of_grain(0.1) * 9.81, dt = 1.0 / 1024;
  collide::reaction_sums sums(space, 1, weight * 1e-12);
  running_bodies<simulation> made(space, w, one_body(w, {}), Integrator{}, effects..., mesh_forces{density_of_grains},
                                  sums.effect(density_of_grains), moving_bodies<>{});
  made.simulation.steps(300, S(dt));
  sums.clear(space);
  made.simulation.steps(128, S(dt));
  double const rounding = sizeof(S) == 4 ? 1e-5 : 1e-9;
  auto const of_body = sums.read(space)[0];
  CHECK(double(made.simulation.template to_host<collide::mesh_force>()[2]) ==
        doctest::Approx(weight).epsilon(rounding));
  CHECK(of_body.linear[2] == doctest::Approx(-weight * 128 * dt).epsilon(rounding));
  CHECK(made.velocities()[2] == 0);
}

template <class NarrowPhase, class S, class Space>
void check_weights(Space const& space) {
  auto const with = [&](auto integrator) {
    using integrator_type = decltype(integrator);
    check_weight<NarrowPhase, integrator_type, S>(space, gravity{}, bounce{0.2});
    check_weight<NarrowPhase, integrator_type, S>(space, gravity{}, bounce{0.2}, adhesion{200});
    check_weight<NarrowPhase, integrator_type, S>(space, collide::sleep{}, gravity{}, bounce{0.2}, friction{});
  };
  with(semi_implicit_euler{});
  with(velocity_verlet{});
}

/// On a slope friction holds both components of the weight; at the foot of a stack is the weight of all.
template <class Integrator, class S, class Space>
void check_slope_and_stack(Space const& space) {
  using detector = meets_mesh<Space, collide::karabassi<>, S>;
  double const weight = mass_of_grain(0.1) * 9.81, rounding = sizeof(S) == 4 ? 1e-4 : 1e-9;
  running<collide::simulation<detector, Integrator, gravity, bounce, friction, mesh_forces>> slope(
      space, ball_on_floor<S>(), Integrator{}, gravity{3, 0, -9.81}, bounce{0.2}, friction{0.9, 0.9},
      mesh_forces{density_of_grains});
  slope.simulation.steps(200, S(1e-3));
  auto const f = slope.simulation.template to_host<collide::mesh_force>();
  CHECK(double(f[0]) == doctest::Approx(-3 / 9.81 * weight).epsilon(rounding));
  CHECK(double(f[2]) == doctest::Approx(weight).epsilon(rounding));

  auto w = ball_on_floor<S>();
  for (int i = 1; i < 3; ++i) w.particle(0, 0, 0.1 + 0.1996 * i);
  sphere_contact contact;
  contact.stiffness = 1e6;
  contact.damping = 2000;
  contact.density = density_of_grains;
  running<collide::simulation<detector, Integrator, sphere_contact, gravity, bounce, mesh_forces>> stack(
      space, w, Integrator{}, contact, gravity{}, bounce{0.2}, mesh_forces{density_of_grains});
  stack.simulation.steps(10000, S(1e-4));
  CHECK(double(stack.simulation.template to_host<collide::mesh_force>()[2]) ==
        doctest::Approx(3 * weight).epsilon(sizeof(S) == 4 ? 0.02 : 1e-3));
  auto const v = stack.velocities();
  for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(double(v[3 * k + 2])) < 2e-4);
}

/// In the corner of bodies each gets its share of the weight, also of what sleeps: two walls at right angles, and an
/// end wall that leans on the ball.
template <class NarrowPhase, class Integrator, class S, class Space>
void check_weight_in_a_corner(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, Integrator, collide::sleep, gravity, bounce,
                                         collide::reaction, moving_bodies<>>;
  double const c = 0.8, s = 0.6, r = 0.1, mass = mass_of_grain(r), dt = 1.0 / 1024;
  world<S> w;
  w.radius = S(r);
  w.particle(r * (c - s), r, r * (c + s));
  add_quad(w, {0, -3, 0}, {3 * c, -3, 3 * s}, {3 * c, 3, 3 * s}, {0, 3, 0});    // normal (-s, 0, c)
  add_quad(w, {0, -3, 0}, {0, 3, 0}, {-3 * s, 3, 3 * c}, {-3 * s, -3, 3 * c});  // normal (c, 0, s)
  add_quad(w, {-3, 0, -3}, {3, 0, -3}, {3, 0, 3}, {-3, 0, 3});                  // normal (0, 1, 0)
  collide::reaction_sums sums(space, 3, mass * 1e-12);
  running_bodies<simulation> made(space, w, {body{0, 2, {}}, body{2, 2, {}}, body{4, 2, {}}}, Integrator{},
                                  collide::sleep{}, gravity{0, -2, -9.81}, bounce{0.2}, sums.effect(density_of_grains),
                                  moving_bodies<>{});
  double const rounding = sizeof(S) == 4 ? 1e-5 : 1e-9;
  for (int const asleep : {0, 1}) {
    made.simulation.steps(asleep == 0 ? 20 : 300, S(dt));
    CHECK((made.simulation.template to_host<slow_steps>()[0] >= 50) == (asleep == 1));
    sums.clear(space);
    made.simulation.steps(16, S(dt));
    auto const found = sums.read(space);
    double const right[3][3] = {{9.81 * c * s, 0, -9.81 * c * c}, {-9.81 * s * c, 0, -9.81 * s * s}, {0, -2, 0}};
    for (std::size_t b = 0; b < 3; ++b) {
      for (int k = 0; k < 3; ++k) CHECK(std::abs(found[b].linear[k] / (mass * 16 * dt) - right[b][k]) < 10 * rounding);
    }
  }
}

/// Sleeping particles are woken where parameters change; not where they are read, or another thing moves.
template <class S, class Space>
void check_waking_by_parameters(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::sleep, gravity, bounce, moving_bodies<>>;
  auto const w = ball_on_floor<S>();
  running_bodies<simulation> made(space, w, one_body(w, {}), collide::sleep{}, gravity{}, bounce{0.2},
                                  moving_bodies<>{});
  auto const slow = [&] { return int(made.simulation.template to_host<slow_steps>()[0]); };
  made.simulation.steps(100, S(1e-3));
  CHECK(slow() == 50);
  auto const x = made.positions();
  simulation const& seen = made.simulation;
  CHECK(seen.template effect<gravity>().z == -9.81);
  CHECK(energy(seen, 1).kinetic == 0);
  made.simulation.template effect<moving_bodies<>>();
  made.simulation.steps(10, S(1e-3));
  CHECK(slow() == 50);
  CHECK(made.positions() == x);
  made.simulation.template effect<gravity>().x = 1;
  made.simulation.steps(100, S(1e-3));
  CHECK(double(made.velocities()[0]) == doctest::Approx(0.1).epsilon(1e-4));
}

/// Spheres in elastic contact: halving the step divides the error of `velocity_verlet` by four.
template <class Space>
void check_order_of_pair_forces(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, velocity_verlet, sphere_contact>;
  world<double> w;
  w.radius = 1;
  w.particle(0, 0, 0, 1, 0, 0);
  w.particle(1.9, 0, 0);
  sphere_contact contact;
  contact.stiffness = 100;
  auto const end = [&](std::size_t n) {
    running<simulation> made(space, w, velocity_verlet{}, contact);
    made.simulation.steps(n, 0.5 / static_cast<double>(n));
    return std::array<double, 2>{made.positions()[0], made.velocities()[0]};
  };
  auto const right = end(16384), coarse = end(32), fine = end(64);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(std::abs(coarse[k] - right[k]) < 5e-3);
    CHECK(std::abs(coarse[k] - right[k]) > 3.5 * std::abs(fine[k] - right[k]));
  }
}

/// A plate that sinks, or rises, more slowly than what is slow takes along what sleeps on it, and what sleeps on that.
template <class NarrowPhase, class S, class Space>
void check_slow_support(Space const& space) {
  using detector = meets_mesh<Space, NarrowPhase, S>;
  for (double const speed : {-0.05, -0.004, 0.004}) {
    auto const w = ball_on_floor<S>();
    body_motion motion;
    motion.velocity[2] = speed;
    running_bodies<collide::simulation<detector, collide::sleep, gravity, bounce, moving_bodies<>>> made(
        space, w, one_body(w, motion), collide::sleep{}, gravity{}, bounce{0.2}, moving_bodies<>{});
    made.simulation.steps(2000, S(1e-3));
    CHECK(double(made.positions()[2]) == doctest::Approx(0.1 + 2 * speed).epsilon(1e-4));
  }
  auto w = ball_on_floor<S>();
  for (int i = 1; i < 4; ++i) w.particle(0, 0, 0.1 + 0.1999 * i);
  body_motion rising;
  rising.velocity[2] = 0.004;
  sphere_contact contact;
  contact.stiffness = 1e6;
  contact.damping = 2000;
  contact.density = density_of_grains;
  running_bodies<collide::simulation<detector, collide::sleep, sphere_contact, gravity, bounce, moving_bodies<>>> stack(
      space, w, one_body(w, rising), collide::sleep{}, contact, gravity{}, bounce{0.2}, moving_bodies<>{});
  stack.simulation.steps(10000, S(2e-4));
  auto const x = stack.positions();
  for (std::size_t k = 0; k < 4; ++k)
    CHECK(double(x[3 * k + 2]) == doctest::Approx(0.1 + 0.1998 * static_cast<double>(k) + 0.008).epsilon(2e-3));
}

/// A particle that spins in place does not sleep before it has come to rest.
template <class NarrowPhase, class S, class Space>
void check_sleep_of_what_spins(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, NarrowPhase, S>, collide::sleep, gravity, bounce, friction, spin>;
  running<simulation> made(space, ball_on_floor<S>(), collide::sleep{}, gravity{}, bounce{0}, friction{0.5, 0.5},
                           spin{0.05});
  placed<S> const turning(made.simulation.space(), {S(0), S(0), S(20)});
  made.simulation.template assign<collide::angular_velocity>(turning.data());
  made.simulation.steps(200, S(1e-3));
  CHECK(made.simulation.template to_host<slow_steps>()[0] == 0);
  made.simulation.steps(2000, S(1e-3));
  CHECK(made.simulation.template to_host<slow_steps>()[0] >= 50);
  CHECK(std::abs(double(made.simulation.template to_host<collide::angular_velocity>()[2])) < 0.1);
}

/// A sphere that hits one asleep loses what that gets, also in the step that wakes it.
template <class Integrator, class S, class Space>
void check_momentum_of_waking(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Integrator, collide::sleep, sphere_contact>;
  world<S> w;
  w.radius = S(0.1);
  w.particle(0, 0, 0);
  w.particle(-0.25, 0, 0);
  w.particle(0.4, 0.05, 0, -1, 0, 0);
  running<simulation> made(space, w, Integrator{}, collide::sleep{},
                           sphere_contact::from_restitution(0.6, 0.03, 0.1, density_of_grains, 0.3));
  placed<std::uint8_t> const asleep(made.simulation.space(), {50, 50, 0});  // they touch nothing
  made.simulation.template assign<slow_steps>(asleep.data());
  made.simulation.steps(150, S(1e-3));
  CHECK(made.simulation.template to_host<slow_steps>()[0] >= 50);
  made.simulation.steps(350, S(1e-3));
  auto const v = made.velocities();
  double const rounding = sizeof(S) == 4 ? 1e-6 : 1e-14;
  CHECK(v[3] < S(-0.1));
  CHECK(std::abs(double(v[0]) + double(v[3]) + double(v[6]) + 1) < rounding);
  CHECK(std::abs(double(v[1]) + double(v[4]) + double(v[7])) < rounding);
}

/// Angular momentum that a ball loses the mesh gets, rolling resistance included.
template <class NarrowPhase, class S, class Space>
void check_angular_momentum(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, NarrowPhase, S>, gravity, bounce, friction, spin, collide::reaction>;
  double const mass = mass_of_grain(0.1), inertia = 0.4 * mass * 0.01, dt = 1e-3;
  for (bool const rolls : {false, true}) {
    auto w = ball_on_floor<S>();
    if (rolls) w.velocities[0] = S(1);
    collide::reaction_sums sums(space, 0, 1e-13);
    running<simulation> made(space, w, gravity{}, bounce{0}, friction{0.9, 0.9}, spin{0.05},
                             sums.effect(density_of_grains));
    placed<S> const turning(made.simulation.space(), {S(0), S(rolls ? 10 : 0), S(rolls ? 0 : 20)});
    made.simulation.template assign<collide::angular_velocity>(turning.data());
    auto const momentum = [&] {
      auto const x = made.positions(), v = made.velocities();
      auto const o = made.simulation.template to_host<collide::angular_velocity>();
      return std::array<double, 2>{
          mass * (double(x[2]) * double(v[0]) - double(x[0]) * double(v[2])) + inertia * double(o[1]),
          inertia * double(o[2])};
    };
    auto const before = momentum();
    double by_gravity = 0;
    for (int i = 0; i < 500; ++i) {
      by_gravity += double(made.positions()[0]) * mass * 9.81 * dt;
      made.simulation.step(S(dt));
    }
    auto const after = momentum();
    auto const got = sums.read(space)[0];
    double const rounding = sizeof(S) == 4 ? 1e-4 : 1e-8;
    CHECK(before[0] - after[0] + by_gravity == doctest::Approx(got.angular[1]).epsilon(rounding));
    CHECK(before[1] - after[1] == doctest::Approx(got.angular[2]).epsilon(rounding));
    CHECK(std::abs(rolls ? before[0] - after[0] : before[1] - after[1]) > 0.01);
  }
}

/// About the z axis, of balls of radius 0.1.
template <class Running>
double angular_momentum(Running const& made, double mass) {
  auto const x = made.positions(), v = made.velocities();
  auto const turning = made.simulation.template to_host<collide::angular_velocity>();
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); i += 3) {
    sum += mass * (double(x[i]) * double(v[i + 1]) - double(x[i + 1]) * double(v[i])) +
           0.4 * mass * 0.01 * double(turning[i + 2]);
  }
  return sum;
}

/// Angular momentum that balls still have to get which the mesh held at the end of a step of velocity Verlet.
template <class Running>
double half_kick_left(Running const& made, double mass, double dt) {
  double sum = 0;
  if constexpr (collide::detail::contains<typename decltype(made.simulation)::columns, collide::held>) {
    auto const held = made.simulation.template to_host<collide::held>();
    auto const x = made.positions();
    auto const a = made.simulation.template to_host<collide::pair_acceleration>();
    auto const turning = made.simulation.template to_host<collide::pair_angular_acceleration>();
    for (std::size_t i = 0; i < x.size(); i += 3) {
      if (held[i / 3] != 1) continue;
      sum += mass * dt / 2 *
             (double(x[i]) * double(a[i + 1]) - double(x[i + 1]) * double(a[i]) + 0.4 * 0.01 * double(turning[i + 2]));
    }
  }
  return sum;
}

/// Angular momentum that balls get on a table that turns far in a step the table loses.
template <class NarrowPhase, class S, class Space>
void check_angular_momentum_of_turntable(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, gravity, bounce, friction, spin,
                                         collide::reaction, moving_bodies<>>;
  auto w = ball_on_floor<S>();
  for (int i = 1; i < 8; ++i) w.particle(0.2 * i, 0.1 * i, 0.1 + 0.05 * i);
  body_motion turns;
  turns.rate = 5;
  double const mass = mass_of_grain(0.1);
  collide::reaction_sums sums(space, 1, 1e-12);
  running_bodies<simulation> made(space, w, one_body(w, turns), gravity{}, bounce{0.5}, friction{0.4, 0.4}, spin{0.02},
                                  sums.effect(density_of_grains), moving_bodies<>{});
  made.simulation.steps(60, S(0.01));
  double const got = angular_momentum(made, mass);
  CHECK(got > 10);
  CHECK(sums.read(space)[0].angular[2] == doctest::Approx(-got).epsilon(sizeof(S) == 4 ? 2e-5 : 1e-10));
}

/// The same of balls that stick to the table, and of others that push and turn them.
template <class NarrowPhase, class Integrator, class S, class Space>
void check_angular_momentum_of_riders(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, Integrator, gravity, sphere_contact, bounce,
                                         friction, spin, adhesion, collide::reaction, moving_bodies<>>;
  auto w = ball_on_floor<S>();
  for (int i = 1; i < 27; ++i) w.particle(0.199 * (i % 3) + 0.3, 0.199 * (i / 3 % 3), 0.101 + 0.21 * (i / 9));
  body_motion turns;
  turns.rate = 2;
  double const mass = mass_of_grain(0.1);
  collide::reaction_sums sums(space, 1, 1e-11);
  running_bodies<simulation> made(space, w, one_body(w, turns), Integrator{}, gravity{},
                                  sphere_contact::from_restitution(0.5, 0.02, 0.1, density_of_grains, 0.3), bounce{0.3},
                                  friction{0.5, 0.5}, spin{0.02}, adhesion{30, 1}, sums.effect(density_of_grains),
                                  moving_bodies<>{});
  made.simulation.steps(600, S(1e-3));
  auto const stuck = made.simulation.template to_host<collide::adhered>();
  CHECK(std::count(stuck.begin(), stuck.end(), 2) > 1);
  CHECK(sums.read(space)[0].angular[2] == doctest::Approx(-angular_momentum(made, mass)).epsilon(1e-9));
}

/// The same about what sleeps on a floor beside balls that push and turn it.
template <class NarrowPhase, class Integrator, class S, class Space>
void check_angular_momentum_beside_sleepers(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, Integrator, gravity, sphere_contact, bounce,
                                         friction, spin, adhesion, collide::sleep, collide::reaction>;
  auto w = ball_on_floor<S>();
  for (int i = 1; i < 27; ++i) w.particle(0.199 * (i % 3) + 0.3, 0.199 * (i / 3 % 3), 0.101 + 0.21 * (i / 9));
  double const mass = mass_of_grain(0.1);
  collide::reaction_sums sums(space, 0, 1e-12);
  running<simulation> made(space, w, Integrator{}, gravity{},
                           sphere_contact::from_restitution(0.5, 0.02, 0.1, density_of_grains, 0.3), bounce{0.3},
                           friction{0.5, 0.5}, spin{0.02}, adhesion{30, 0.3}, collide::sleep{0.05, 10},
                           sums.effect(density_of_grains));
  int asleep = 0;
  for (int i = 0; i < 10; ++i) {
    made.simulation.steps(40, S(1e-3));
    auto const slow = made.simulation.template to_host<slow_steps>();
    auto const now = std::count_if(slow.begin(), slow.end(), [](int n) { return n >= 10 && n < 128; });
    if (now < 27) asleep += int(now);
  }
  CHECK(asleep > 10);
  double const kept = angular_momentum(made, mass) + half_kick_left(made, mass, 1e-3);
  CHECK(std::abs(kept) > 0.1);
  CHECK(sums.read(space)[0].angular[2] == doctest::Approx(-kept).epsilon(sizeof(S) == 4 ? 1e-4 : 1e-9));
}

/// Where balls that spin touch both walls of a corner, friction at one wall takes speed from the way to the other: no
/// elastic bounce gives it back.
template <class NarrowPhase, class S, class Space>
void check_energy_in_a_corner(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, bounce, friction, spin>;
  world<S> w;
  w.radius = S(0.1);
  for (double side : {-9.0, 9.0}) {
    w.triangle({0, -9, 0, side, -9, 9, side, 9, 9});
    w.triangle({0, -9, 0, side, 9, 9, 0, 9, 0});
  }
  for (int i = 0; i < 200; ++i) w.particle(0.0005 * (i - 100), 0.02 * i - 2, 0.45, 0.003 * (i - 100), 0.3, -3);
  running<simulation> made(space, w, bounce{1}, friction{0.4, 0.4}, spin{0});
  made.simulation.steps(60, S(5e-3));
  auto const v = made.velocities(), turning = made.simulation.template to_host<collide::angular_velocity>();
  double most = 0;  // of what energy is to what it was
  for (std::size_t i = 0; i < w.size(); ++i) {
    double before = 0, after = 0;
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
      before += double(w.velocities[k]) * double(w.velocities[k]);
      after += double(v[k]) * double(v[k]) + 0.004 * double(turning[k]) * double(turning[k]);
    }
    most = std::max(most, after / before);
  }
  CHECK(most < 1 + 1e-5);
  CHECK(most > 0.5);
}

/// Balls that bounce elastically in a corner of three slanted walls have no more energy afterwards, with gravity too.
template <class NarrowPhase, class S, class Space>
void check_elastic_corner(Space const& space, double g, double most_growth) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, velocity_verlet, gravity, bounce>;
  world<S> w;
  w.radius = S(0.1);
  w.triangle({0, 0, 0, 9, 0, 4, -3, 8, 5});
  w.triangle({0, 0, 0, -3, 8, 5, -5, -7, 6});
  w.triangle({0, 0, 0, -5, -7, 6, 9, 0, 4});
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 300; ++i) {
    w.particle(0.1 * uniform(engine), 0.1 * uniform(engine), 0.6 + 0.1 * uniform(engine), uniform(engine),
               uniform(engine), -2 + uniform(engine));
  }
  running<simulation> made(space, w, velocity_verlet{}, gravity{0, 0, -g}, bounce{1});
  auto const energies = [&] {
    auto const x = made.positions(), v = made.velocities();
    std::vector<double> all;
    for (std::size_t i = 0; i < w.size(); ++i) {
      double square = 0;
      for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) square += double(v[k]) * double(v[k]);
      all.push_back(square / 2 + g * double(x[3 * i + 2]));
    }
    return all;
  };
  auto const before = energies();
  made.simulation.steps(150, S(2e-3));
  auto const after = energies();
  double most = 0, total = 0, total_before = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    most = std::max(most, after[i] / before[i] - 1);
    total += after[i];
    total_before += before[i];
  }
  CHECK(most < most_growth);
  CHECK(total < total_before * (1 + most_growth));
  CHECK(total > total_before * 0.5);
}

/// Friction between spheres that overlap keeps the angular momentum of the two: its arms are the distance.
template <class S, class Space>
void check_arms_of_spheres(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::polydisperse, spin, sphere_contact>;
  world<S> w;
  w.triangle({100, 0, 0, 101, 0, 0, 101, 1, 0});
  w.radii = {S(0.1), S(0.05)};
  w.particle(0, 0, 0, 1, 0, 0);
  w.particle(0.15, 0.06, 0, -2, 0.3, 0);
  running<simulation> made(space, w, collide::polydisperse{}, spin{0},
                           sphere_contact::from_restitution(0.8, 0.02, 0.1, density_of_grains, 0.4));
  auto const momentum = [&] {
    auto const x = made.positions(), v = made.velocities();
    auto const turning = made.simulation.template to_host<collide::angular_velocity>();
    double sum = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      double const r = double(w.radii[i]), m = mass_of_grain(r);
      sum += m * (double(x[3 * i]) * double(v[3 * i + 1]) - double(x[3 * i + 1]) * double(v[3 * i])) +
             0.4 * m * r * r * double(turning[3 * i + 2]);
    }
    return sum;
  };
  double const before = momentum();
  made.simulation.steps(500, S(2e-4));
  CHECK(std::abs(double(made.simulation.template to_host<collide::angular_velocity>()[2])) > 1);
  CHECK(momentum() == doctest::Approx(before).epsilon(sizeof(S) == 4 ? 1e-4 : 1e-11));
}

/// A user's effect: particle 0 is pushed by what overlaps it.
struct pushes {
  using writes = collide::columns<velocity>;
  double x = 0, z = 0;  ///< acceleration
  template <class Particle, class Seen, class S>
  COLLIDE_HD void on_pair_contact(Particle& p, Seen const& self, Seen const&, S dt) const {
    if (self.number() == 0) p[velocity{}] += collide::vec3<S>(S(x), S(0), S(z)) * dt;
  }
};

/// A user's effect between particles that leaves velocities alone.
struct cools {
  using writes = collide::columns<temperature>;
  template <class Particle, class Seen, class S>
  COLLIDE_HD void on_pair_contact(Particle& p, Seen const&, Seen const& other, S) const {
    p[temperature{}] = other[temperature{}];
  }
};

/// Effects between particles need not change velocities, whatever is kept of those that do.
template <class Space>
void check_pairs_without_forces(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space>, velocity_verlet, cools, gravity, bounce, friction, spin, adhesion>;
  auto w = ball_on_floor<float>();
  w.particle(0.15, 0, 0.1);
  running<simulation> made(space, w, velocity_verlet{}, cools{}, gravity{}, bounce{}, friction{}, spin{}, adhesion{});
  placed<float> const warm(made.simulation.space(), {1, 2});
  made.simulation.template assign<temperature>(warm.data());
  made.simulation.step(1e-3f);
  CHECK(made.simulation.template to_host<temperature>()[0] == 2);  // once in a step
  CHECK(made.velocities()[0] == 0);
}

/// A particle that adhesion holds is pulled off by another with more than it holds, and with no less; pulled along the
/// mesh then slides as under gravity.
template <class NarrowPhase, class Integrator, class S, class Space>
void check_adhesion_and_others(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, Integrator, pushes, bounce, adhesion>;
  auto const after = [&](double x, double z, int steps, double dt) {
    auto w = ball_on_floor<S>();
    w.radius = S(0.2);
    w.centres[2] = S(0.2);
    w.velocities[2] = S(-0.01);
    w.particle(0.1, 0, 0.55);
    running<simulation> made(space, w, Integrator{}, pushes{}, bounce{0.2}, adhesion{10});
    made.simulation.steps(2, S(dt));  // it sticks
    made.simulation.template effect<pushes>() = {x, z};
    made.simulation.steps(static_cast<std::size_t>(steps), S(dt));
    return made.positions();
  };
  for (double const pull : {6.0, 9.0}) CHECK(std::abs(double(after(0, pull, 20, 1e-3)[2]) - 0.2) < 1e-5);
  CHECK(after(0, 11, 20, 1e-3)[2] > S(0.201));
  CHECK(after(9, 0, 20, 1e-3)[0] == 0);
  for (double const dt : {1e-3, 1e-4}) {
    CHECK(double(after(15, 0, int(std::lround(0.1 / dt)), dt)[0]) == doctest::Approx(0.075).epsilon(0.02));
  }
}

/// A particle that stuck to a surface falls where that is gone, and stays where it is not.
template <class NarrowPhase, class S, class Space>
void check_adhesion_without_surface(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, gravity, bounce, adhesion, moving_bodies<>>;
  auto const w = ball_on_floor<S>();
  body_motion moves;
  moves.velocity[0] = 0.5;
  auto const after = [&](double down, std::vector<body> const& bodies) {
    running_bodies<simulation> made(space, w, one_body(w, moves), gravity{}, bounce{0.2}, adhesion{20},
                                    moving_bodies<>{});
    made.simulation.steps(128, S(1.0 / 1024));
    auto corners = w.corners;
    for (std::size_t i = 2; i < corners.size(); i += 3) corners[i] -= S(down);
    placed<S> const mesh(space, corners);
    made.simulation.set_mesh(collide::triangle_soup(mesh.data(), mesh.size() / 9), bodies);
    made.simulation.steps(512, S(1.0 / 1024));
    auto x = made.positions();
    x.push_back(S(made.simulation.template to_host<collide::adhered>()[0]));
    return x;
  };
  auto const gone = after(5, {}), rests = after(0, {}), moved = after(0, one_body(w, moves));
  CHECK(double(gone[2]) == doctest::Approx(0.1 - 9.81 * 0.125).epsilon(0.01));
  CHECK(gone[3] == 0);
  CHECK(rests[2] == S(0.1));
  CHECK(rests[3] == 1);
  CHECK(double(moved[0] - rests[0]) > 0.2);
  CHECK(moved[3] == 2);
}

/// A particle on a plate that goes out of a box that repeats comes in on the other side, where no plate is, and falls.
template <class NarrowPhase, class S, class Space>
void check_adhesion_across(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, gravity, bounce, adhesion,
                                         collide::periodic_box, moving_bodies<>>;
  world<S> w;
  w.radius = S(0.1);
  add_floor(w, 0.5, 1);
  w.particle(0.4, 0, 0.1);
  body_motion moves;
  moves.velocity[0] = 1;
  running_bodies<simulation> made(space, w, one_body(w, moves), gravity{}, bounce{0.2}, adhesion{20},
                                  collide::periodic_box{{-1, -1, -1}, {1, 1, 1}}, moving_bodies<>{});
  made.simulation.steps(500, S(1e-3));
  CHECK(int(made.simulation.template to_host<collide::adhered>()[0]) == 2);
  CHECK(double(made.positions()[0]) == doctest::Approx(0.9).epsilon(2e-3));
  made.simulation.steps(400, S(1e-3));
  CHECK(int(made.simulation.template to_host<collide::adhered>()[0]) == 0);
  CHECK(double(made.positions()[2]) < -0.2);
}

/// A particle that stuck to a driven body is free where the next list of bodies does not have that.
template <class Space>
void check_driven_body_that_is_gone(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, gravity, bounce, adhesion, moving_bodies<collide::driven>>;
  auto const w = ball_on_floor<float>();
  running_bodies<simulation> made(space, w, {body{0, 0, {}}, body{0, 2, {}}}, gravity{}, bounce{0.2}, adhesion{20},
                                  moving_bodies<collide::driven>{});
  made.simulation.steps(100, 1e-3f);
  CHECK(made.simulation.template to_host<collide::adhered>()[0] == 3);
  placed<float> const mesh(space, w.corners);
  made.simulation.set_mesh(collide::triangle_soup(mesh.data(), 2), {body{0, 2, {}}});
  CHECK(made.simulation.template to_host<collide::adhered>()[0] == 0);
}

/// A driven body is never where it lies in memory: not in its first step, nor when the mesh is set again.
template <class NarrowPhase, class S, class Space>
void check_first_pose(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, bounce, moving_bodies<collide::driven>>;
  auto w = ball_on_floor<S>();
  w.centres[2] = S(2.5);
  running_bodies<simulation> made(space, w, one_body(w, {}), bounce{0.5}, moving_bodies<collide::driven>{});
  collide::body_state state;
  state.at.position[2] = 5;
  placed<S> const mesh(space, w.corners);
  for (int i = 0; i < 20; ++i) {
    if (i == 10) made.simulation.set_mesh(collide::triangle_soup(mesh.data(), 2), one_body(w, {}));
    made.simulation.space().copy_from_host(made.simulation.bodies().states(), &state, 1);
    made.simulation.step(S(1e-3));
    made.simulation.space().synchronize();
  }
  CHECK(made.positions()[2] == S(2.5));
  CHECK(made.velocities()[2] == 0);
}

/// A particle that friction holds on a turntable goes round with it, to rounding.
template <class Space>
void check_turntable(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, gravity, bounce, friction, moving_bodies<>>;
  auto w = ball_on_floor<double>();
  w.centres[0] = 0.5;
  w.velocities[1] = 1;
  body_motion turns;
  turns.rate = 2;
  running_bodies<simulation> made(space, w, one_body(w, turns), gravity{}, bounce{0}, friction{0.6, 0.6},
                                  moving_bodies<>{});
  double const dt = 1e-2;
  made.simulation.steps(100, dt);
  auto const x = made.positions();
  made.simulation.steps(5000, dt);
  auto const y = made.positions();
  double const c = std::cos(2 * 5000 * dt), s = std::sin(2 * 5000 * dt);
  CHECK(std::abs(y[0] - (c * x[0] - s * x[1])) < 1e-9);
  CHECK(std::abs(y[1] - (s * x[0] + c * x[1])) < 1e-9);
}

/// A particle held by friction on a plane far from the origin of its floats, `rise` higher for each step in y, that
/// turns about its own normal.
template <class Space>
struct far_plane {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi_swept<>>, gravity, bounce, friction, moving_bodies<>>;
  double const far[3];
  running_bodies<simulation> made;

  far_plane(Space const& space, double x, double y, double z, double rise, double rate)
      : far{x, y, z},
        made(space, lying(rise), one_body(lying(rise), turning(rise, rate)), gravity{}, bounce{0}, friction{0.6, 0.6},
             moving_bodies<>{}) {}

  void steps(std::size_t n) { made.simulation.steps(n, 1e-3f); }
  double distance() const {
    auto const x = made.positions();
    return std::hypot(double(x[0]) - far[0], double(x[1]) - far[1], double(x[2]) - far[2]);
  }

 private:
  world<float> lying(double rise) const {
    world<float> w;
    w.radius = 0.1f;
    double const x = far[0], y = far[1], z = far[2], up = 0.1 / std::hypot(1, rise);
    w.triangle({x - 3, y - 3, z - 3 * rise, x + 3, y - 3, z - 3 * rise, x, y + 3, z + 3 * rise});
    w.particle(x + 0.5, y - up * rise, z + up);
    return w;
  }
  body_motion turning(double rise, double rate) const {
    body_motion turns;
    std::copy(far, far + 3, turns.pivot);
    turns.axis[1] = -rise;
    turns.rate = rate;
    return turns;
  }
};

/// It does not drift outward on a level turntable, and keeps its place on a slope.
template <class Space>
void check_far_planes(Space const& space) {
  for (double const far : {0.0, 10.0, 100.0}) {
    for (double const height : {0.0, far}) {
      far_plane<Space> table(space, far, far, height, 0, 2);
      table.steps(1000);
      double const before = table.distance();
      table.steps(20000);
      CHECK(std::abs(table.distance() / before - 1) < 1e-3);
    }
    far_plane<Space> slope(space, far, far, far, 0.4, 0);
    slope.steps(100);
    auto const before = slope.made.positions();
    slope.steps(5000);
    CHECK(slope.made.positions() == before);
  }
}

/// Numbers written into columns count as if the simulation began with them, whatever slept, stuck, or was smaller.
template <class NarrowPhase, class Integrator, class S, class Space>
void check_assigned(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, Integrator, collide::polydisperse,
                                         collide::sleep, gravity, sphere_contact, bounce, adhesion>;
  sphere_contact contact;
  contact.density = density_of_grains;
  auto resting = ball_on_floor<S>();
  resting.particle(1, 0, 0.1);
  resting.particle(0, 1, 0.1);
  resting.radii = {S(0.1), S(0.1), S(0.1)};
  auto other = ball_on_floor<S>();
  other.centres[2] = S(2);
  other.velocities[2] = S(1);
  other.particle(0.7, 0, 2);
  other.particle(0, 2, 0.504, 0, 0, -1);
  other.radii = {S(0.5), S(0.5), S(0.5)};
  auto const with = [&](world<S> const& w) {
    return running<simulation>(space, w, Integrator{}, collide::polydisperse{}, collide::sleep{}, gravity{}, contact,
                               bounce{0.2}, adhesion{20, 0.5});
  };
  auto made = with(resting), begun = with(other);
  made.simulation.steps(100, S(1e-3));
  CHECK(int(made.simulation.template to_host<slow_steps>()[0]) == 50);
  CHECK(int(made.simulation.template to_host<collide::adhered>()[0]) == 1);
  placed<S> const x(space, other.centres), v(space, other.velocities), r(space, other.radii);
  made.simulation.template assign<position>(x.data());
  made.simulation.template assign<velocity>(v.data());
  made.simulation.template assign<collide::radius>(r.data());
  for (auto* one : {&made, &begun}) one->simulation.steps(20, S(1e-3));
  CHECK(made.positions() == begun.positions());
  CHECK(made.velocities() == begun.velocities());
  CHECK(made.velocities()[3] > 0);
  placed<S> const none(space, std::vector<S>(3, S(0)));
  CHECK_THROWS_WITH_AS(made.simulation.template assign<collide::radius>(none.data()),
                       "collide: simulation: assign: radii of particles that touch a mesh are above 0", collide::error);
}

/// The first two that begin are a stack; the others are elsewhere.
struct stack_first {
  template <class S>
  COLLIDE_HD void operator()(std::uint64_t number, collide::vec3<S>& x, collide::vec3<S>& v) const {
    bool const is_low = number != 1;
    x = collide::vec3<S>(number < 2 ? S(0) : S(2), S(0), is_low ? S(0.1) : S(0.3));
    v = collide::vec3<S>(S(0), S(0), S(0));
  }
};

/// A particle asleep on one whose place a source takes falls.
template <class S, class Space>
void check_place_of_another(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::sleep, gravity,
                                         sphere_contact, bounce, collide::emit_from<stack_first>>;
  auto w = ball_on_floor<S>();
  w.centres[0] = S(-1);
  running<simulation> made(space, w, collide::sleep{}, gravity{}, sphere_contact{1e6, 2000, 0, 0, density_of_grains},
                           bounce{0.2}, collide::emit_from<stack_first>{4, {}});
  made.place(w, 3);
  made.simulation.steps(740, S(1e-3));
  CHECK(made.simulation.template to_host<slow_steps>()[2] >= 50);
  CHECK(double(made.positions()[8]) == doctest::Approx(0.3).epsilon(1e-3));
  made.simulation.steps(230, S(1e-3));
  CHECK(made.positions()[3] == S(2));
  CHECK(made.positions()[8] < S(0.15));
}

/// A grain that sleeps on another goes on to lie there where a source takes a place of one that it does not touch.
template <class Integrator, class S, class Space>
void check_place_far_away(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Integrator, collide::sleep,
                                         gravity, sphere_contact, bounce, collide::emit>;
  auto w = ball_on_floor<S>();
  w.particle(0, 0, 0.2996);
  running<simulation> made(space, w, Integrator{}, collide::sleep{}, gravity{},
                           sphere_contact{1e6, 2000, 0, 0, density_of_grains}, bounce{0.2},
                           collide::emit{2, {{2, 0, 0.1}}});
  made.place(w, 3);
  made.simulation.steps(1000, S(1.0 / 1024));
  auto const slow = [&] { return made.simulation.template to_host<slow_steps>()[1]; };
  CHECK(slow() >= 50);
  for (int i = 0; i < 48 && slow() >= 50; ++i) made.simulation.step(S(1.0 / 1024));
  CHECK(slow() == 1);
  CHECK(std::abs(double(made.velocities()[5])) < 1e-3);  // in half a step it would fall by 5e-3
}

/// Particles that are nowhere are counted, and the others go on.
template <class Space>
void check_lost(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, gravity, bounce, sphere_contact, collide::lost>;
  auto w = ball_on_floor<float>();
  w.particle(1, 0, 0.1);
  w.particle(std::numeric_limits<double>::quiet_NaN(), 0, 0.1);
  w.particle(0, 0, 1, 0, std::numeric_limits<double>::infinity(), 0);
  running<simulation> made(space, w, gravity{}, bounce{0.2}, sphere_contact{}, collide::lost{});
  CHECK(collide::lost_count(made.simulation) == 0);
  made.simulation.steps(10, 1e-4f);
  CHECK(collide::lost_count(made.simulation) == 2);
  CHECK(made.positions()[5] == doctest::Approx(0.1));
}

}  // namespace tests
