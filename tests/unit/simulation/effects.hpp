/// Effects in a space, against closed forms; instantiated by test_effects.cpp and test_effects_cuda.cpp.
#pragma once

#include <numeric>

#include <collide/effects/absorb.hpp>
#include <collide/effects/adhesion.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/drag.hpp>
#include <collide/effects/emit.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/effects/spin.hpp>
#include <collide/effects/wind.hpp>

#include "simulation/simulation.hpp"

namespace tests {

using collide::adhered;
using collide::alive;
using collide::angular_velocity;
using collide::bounce;
using collide::drag;
using collide::friction;
using collide::gravity;
using collide::slow_steps;
using collide::sphere_contact;

/// Falling with drag, from rest or thrown up: on the way, and in the end. The closed form, whatever the step.
template <class S, class Integrator, class... Effect, class Space>
void check_drag_of(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Integrator, Effect...>;
  double const g = 9.81, rounding = sizeof(S) == 4 ? 2e-5 : 1e-12;
  auto const velocity_after = [&](drag const& d, double thrown, std::size_t steps, double dt) {
    world<S> w;
    w.particle(0, 0, 0, 0, 0, thrown);
    running<simulation> made(space, w);
    made.simulation.template effect<gravity>().z = -g;
    made.simulation.template effect<drag>() = d;
    made.simulation.steps(steps, S(dt));
    return double(made.velocities()[2]);
  };
  for (double const k : {0.1, 1.0, 10.0, 1000.0}) {  // times dt
    for (std::size_t const steps : {1, 5}) {
      double const time = 0.0625 * double(steps), rate = k / 0.0625;
      double const left = std::exp(-rate * time);
      double const linear = velocity_after({rate, 0}, 3, steps, 0.0625);
      CHECK(linear == doctest::Approx(3 * left - g / rate * (1 - left)).epsilon(rounding).scale(0));
      compared<S>("fall with linear drag", "v = v0 exp(-k t) - g / k (1 - exp(-k t))", linear,
                  3 * left - g / rate * (1 - left));
      double const quadratic = rate * rate / g, slow = g / rate;  // tanh(rate t)
      double const falling = velocity_after({0, quadratic}, 0, steps, 0.0625);
      CHECK(falling == doctest::Approx(-slow * std::tanh(rate * time)).epsilon(rounding).scale(0));
      compared<S>("fall with quadratic drag", "v = -sqrt(g / k) tanh(sqrt(g k) t)", falling,
                  -slow * std::tanh(rate * time));
      double const stops = std::atan(3 / slow) / rate;  // what is thrown up
      CHECK(velocity_after({0, quadratic}, 3, steps, 0.0625) ==
            doctest::Approx(time < stops ? slow * std::tan(rate * (stops - time))
                                         : -slow * std::tanh(rate * (time - stops)))
                .epsilon(rounding)
                .scale(0));
    }
  }
  double const terminal = velocity_after({0, 0.5}, 0, 20000, 0.015625);
  CHECK(terminal == doctest::Approx(-std::sqrt(g / 0.5)).epsilon(rounding));
  compared<S>("terminal velocity", "v = -sqrt(g / k)", terminal, -std::sqrt(g / 0.5));
  CHECK(std::isfinite(velocity_after({1e6, 1e6}, 1e3, 100, 1)));  // however strong
  CHECK(velocity_after({0, 0}, 3, 1, 0.125) == doctest::Approx(3 - g / 8).epsilon(1e-6));
}

template <class Space>
void check_drag(Space const& space) {
  using euler = collide::semi_implicit_euler;
  using verlet = collide::velocity_verlet;
  check_drag_of<float, euler, gravity, drag>(space);
  check_drag_of<float, verlet, drag, gravity>(space);
  check_drag_of<double, euler, drag, gravity>(space);
  check_drag_of<double, verlet, gravity, drag>(space);
  // with a medium that does not move, too, and what sticks does so: it judges what has been resisted
  using simulation = collide::simulation<meets_mesh<Space>, bounce, collide::adhesion, drag, gravity, collide::wind<>>;
  world<float> w;
  add_floor(w, 4, 8);
  w.radius = 0.1f;
  w.particle(0.1, 0.2, 9, 0, 0, 0);
  w.particle(0.1, 0.2, 0.1, 0, 0, 0);
  running<simulation> made(space, w, bounce{0}, collide::adhesion{}, drag{0, 0.25}, gravity{},
                           collide::wind<>{0, 0.25, {}});
  made.simulation.steps(80, 0.015625f);
  CHECK(double(made.velocities()[2]) ==
        doctest::Approx(-std::sqrt(9.81 / 0.5) * std::tanh(1.25 * std::sqrt(9.81 * 0.5))).epsilon(1e-5));
  auto const x = made.positions();
  CHECK(x[5] == 0.1f);
  made.simulation.template effect<collide::wind<>>().field.x = 8;  // 16 in all: less than adhesion holds
  made.simulation.steps(10, 0.0625f);
  CHECK(made.positions()[3] == x[3]);
  made.simulation.template effect<collide::wind<>>().field.x = 20;
  made.simulation.steps(10, 0.0625f);
  CHECK(made.positions()[3] > x[3] + 0.5f);
}

/// Positions and velocities of what falls on a floor in two media, however strong.
template <class S, class Integrator, class Space>
std::vector<S> fallen_in_media(Space const& space, double strength) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Integrator, drag, gravity, bounce,
                                         collide::wind<>>;
  world<S> w;
  add_floor(w, 4, 8);
  w.radius = S(0.1);
  for (int i = 0; i < 100; ++i) {
    double const x = i;
    w.particle(0.03 * x - 1.5, 0.02 * x - 1, 0.1 + 0.01 * x, std::sin(x), std::cos(3 * x), std::sin(7 * x));
  }
  running<simulation> made(space, w, Integrator{}, drag{0.2 * strength, 0.3 * strength}, gravity{}, bounce{0.5},
                           collide::wind<>{0.1, strength, {1, 2, 0}});
  made.simulation.steps(200, S(1e-3));
  auto found = made.positions();
  auto const v = made.velocities();
  found.insert(found.end(), v.begin(), v.end());
  return found;
}

/// A field that a user might write: air that turns around the z axis.
struct vortex {
  double rate = 1;
  template <class S>
  COLLIDE_HD collide::vec3<S> operator()(collide::vec3<S> const& x) const {
    return {-S(rate) * x.y(), S(rate) * x.x(), S(0)};
  }
};

template <class Space>
void check_wind(Space const& space) {
  world<float> w;
  w.particle(0, 0, 0);
  w.particle(3, 0, 0, 0, 0, 1);
  running<collide::simulation<meets_mesh<Space>, collide::wind<>>> blown(space, w, collide::wind<>{4, 0.1, {5, -1, 2}});
  blown.simulation.steps(5000, 1e-3f);
  auto v = blown.velocities();
  for (std::size_t i = 0; i < 6; ++i)
    CHECK(v[i] == doctest::Approx(i % 3 == 0 ? 5 : (i % 3 == 1 ? -1 : 2)).epsilon(1e-4));
  running<collide::simulation<meets_mesh<Space>, collide::wind<vortex>>> turned(space, w,
                                                                                collide::wind<vortex>{1, 0, {2}});
  turned.simulation.step(1e-3f);
  v = turned.velocities();
  CHECK(v[3] == 0);
  CHECK(v[4] == doctest::Approx(6e-3).epsilon(2e-3));
  CHECK(v[5] == doctest::Approx(1 - 1e-3).epsilon(1e-4));
}

/// Balls that do not spin, on an incline made of triangles: how far down they are after a second.
template <class NarrowPhase, class Space>
std::vector<double> slid(Space const& space, double slope, friction const& f, double speed) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase>, gravity, bounce, friction>;
  double const angle = std::atan(slope), c = std::cos(angle), s = std::sin(angle), radius = 0.1;
  world<float> flat, w;
  add_floor(flat, 12, 24);
  for (std::size_t i = 0; i < flat.corners.size(); i += 3) {  // turned about the y axis: x leads down
    double const x = double(flat.corners[i]), y = double(flat.corners[i + 1]);
    for (double v : {x * c, y, -x * s}) w.corners.push_back(static_cast<float>(v));
  }
  w.radius = static_cast<float>(radius);
  for (int i = 0; i < 8; ++i) {
    double const x = -2 + 0.21 * i, y = -3 + 0.7 * i;
    w.particle(x * c + radius * s, y, -x * s + radius * c, speed * c, 0, -speed * s);
  }
  running<simulation> made(space, w, gravity{}, bounce{0.3}, f);
  made.simulation.steps(4000, 2.5e-4f);
  auto const x = made.positions();
  std::vector<double> far;
  for (std::size_t i = 0; i < w.size(); ++i) {
    far.push_back((double(x[3 * i]) - double(w.centres[3 * i])) * c -
                  (double(x[3 * i + 2]) - double(w.centres[3 * i + 2])) * s);
    CHECK(double(x[3 * i]) * s + double(x[3 * i + 2]) * c == doctest::Approx(radius).epsilon(1e-3));  // on the surface
  }
  return far;
}

template <class NarrowPhase, class Space>
void check_incline(Space const& space) {
  double const g = 9.81;
  auto const check = [&](double slope, friction const& f, double speed, double expected) {
    for (double far : slid<NarrowPhase>(space, slope, f, speed)) {
      if (expected == 0) {
        compared<float>("friction holds on an incline", "s = 0 if tan a <= mu", far, 0);
      } else if (slope > f.kinetic_coefficient) {
        compared<float>("sliding down an incline", "s = v t + g (sin a - mu cos a) t² / 2", far, expected);
      } else {
        compared<float>("sliding to a stop on an incline", "s = v² / (2 g (mu cos a - sin a))", far, expected);
      }
      if (expected == 0) {
        CHECK(std::abs(far) < 1e-4);
      } else {
        CHECK(far == doctest::Approx(expected).epsilon(0.01));
      }
    }
  };
  auto const acceleration = [&](double slope, double mu) { return g * (slope - mu) / std::sqrt(1 + slope * slope); };
  for (double const mu : {0.2, 0.7}) {
    check(0.98 * mu, {mu, mu}, 0, 0);
    check(1.1 * mu, {mu, mu}, 0, acceleration(1.1 * mu, mu) / 2);
  }
  check(0.5, {0.6, 0.3}, 0, 0);  // statical friction holds, what moves is slowed down by kinetic friction only
  check(0.5, {0.6, 0.3}, 1, 1 + acceleration(0.5, 0.3) / 2);
  double const stops = acceleration(0.1, 0.5);
  check(0.1, {0.5, 0.5}, 2, -2 * 2 / (2 * stops));  // slides until it stops, and stays
}

/// Sliding becomes rolling at 5/7 of the speed; down a slope a rolling ball has 5/7 of the acceleration.
template <class NarrowPhase, class Space>
void check_rolling(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase>, gravity, bounce, friction, collide::spin>;
  static_assert(simulation::bytes_per_particle == 36, "positions, velocities and angular velocities");
  world<float> w;
  add_floor(w, 12, 24);
  w.radius = 0.2f;
  for (int i = 0; i < 8; ++i) w.particle(-6, -5 + i, 0.2, 2, 0.25 * i, 0);
  running<simulation> made(space, w, gravity{}, bounce{0.3}, friction{0.4, 0.4}, collide::spin{});
  made.simulation.steps(3000, 1e-3f);
  auto v = made.velocities(), turn = made.simulation.template to_host<angular_velocity>();
  for (std::size_t i = 0; i < w.size(); ++i) {
    CHECK(v[3 * i] == doctest::Approx(2 * 5 / 7.0).epsilon(1e-3));
    compared<float>("sliding becomes rolling", "v = 5/7 v0", double(v[3 * i]), 2 * 5 / 7.0);
    CHECK(v[3 * i + 1] == doctest::Approx(0.25 * double(i) * 5 / 7.0).epsilon(1e-3));
    CHECK(turn[3 * i + 1] * 0.2f == doctest::Approx(v[3 * i]).epsilon(1e-3));
    CHECK(turn[3 * i] * 0.2f == doctest::Approx(-v[3 * i + 1]).epsilon(1e-3));
  }
  world<float> still = w;
  std::fill(still.velocities.begin(), still.velocities.end(), 0.0f);
  running<simulation> down(space, still, gravity{2, 0, -9}, bounce{0.3}, friction{0.4, 0.4}, collide::spin{});
  down.simulation.steps(2000, 1e-3f);
  v = down.velocities();
  for (std::size_t i = 0; i < w.size(); ++i) {
    CHECK(v[3 * i] == doctest::Approx(2 * 2 * 5 / 7.0).epsilon(2e-3));
    compared<float>("rolling down an incline", "v = 5/7 g sin a t", double(v[3 * i]), 2 * 2 * 5 / 7.0);
  }

  running<simulation> slowed(space, still, gravity{2, 0, -9}, bounce{0.3}, friction{0.4, 0.4}, collide::spin{0.05});
  slowed.simulation.steps(2000, 1e-3f);
  v = slowed.velocities();
  for (std::size_t i = 0; i < w.size(); ++i) {
    CHECK(v[3 * i] == doctest::Approx(5 / 7.0 * (2 - 0.05 * 9) * 2).epsilon(2e-3));
    compared<float>("rolling down an incline with rolling resistance", "v = 5/7 g (sin a - mu_r cos a) t",
                    double(v[3 * i]), 5 / 7.0 * (2 - 0.05 * 9) * 2);
  }

  running<simulation> resisted(space, w, gravity{}, bounce{0.3}, friction{0.4, 0.4}, collide::spin{0.05});
  resisted.simulation.steps(8000, 1e-3f);
  v = resisted.velocities();
  for (std::size_t i = 0; i < w.size(); ++i) CHECK(std::abs(v[3 * i]) < 1e-3);
}

/// Sums over all particles, in double.
template <class S>
double kinetic_energy(std::vector<S> const& v) {
  double sum = 0;
  for (S x : v) sum += double(x) * double(x);
  return sum / 2;
}
template <class S>
double momentum(std::vector<S> const& v, std::size_t axis) {
  double sum = 0;
  for (std::size_t i = axis; i < v.size(); i += 3) sum += double(v[i]);
  return sum;
}

/// Two spheres part with e times the speed; many conserve momentum, and energy if e = 1.
template <class S, class Space>
void check_collisions(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, sphere_contact>;
  for (double const e : {1.0, 0.9, 0.5, 0.2}) {
    world<S> w;
    w.radius = S(0.1);
    w.particle(0, 0, 0, 1, 0.5, 0);
    w.particle(0.3, 0, 0, -1, 0.5, 0);
    running<simulation> pair(space, w, sphere_contact::from_restitution(e, 0.01, 0.1, 1000));
    pair.simulation.steps(10000, S(2e-5));
    auto const v = pair.velocities();
    CHECK(double(v[3] - v[0]) == doctest::Approx(2 * e).epsilon(0.01));
    compared<S>("two spheres part, `sphere_contact`", "v = e v0", double(v[3] - v[0]), 2 * e);
    CHECK(std::abs(double(v[0] + v[3])) < 1e-6);
    CHECK(v[1] == S(0.5));
  }
  for (double const f : {0.0, 0.4}) {
    world<S> w;
    w.radius = S(0.05);
    std::mt19937 engine(2);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j)
        for (int k = 0; k < 5; ++k)
          w.particle(0.2 * (i - 2), 0.2 * (j - 2), 0.2 * (k - 2), -(i - 2) + 0.3 * uniform(engine),
                     -(j - 2) + 0.3 * uniform(engine), -(k - 2) + 0.3 * uniform(engine));
    running<simulation> many(space, w, sphere_contact::from_restitution(1, 0.005, 0.05, 1000, f));
    many.simulation.steps(20000, S(1e-4));
    auto const v = many.velocities();
    CHECK((v != w.velocities));
    double const rounding = 125 * 20000 * 1e-3 * double(std::numeric_limits<S>::epsilon());
    for (std::size_t axis = 0; axis < 3; ++axis)
      CHECK(std::abs(momentum(v, axis) - momentum(w.velocities, axis)) < rounding);
    double const before = kinetic_energy(w.velocities), after = kinetic_energy(v);
    if (f == 0) {
      CHECK(after == doctest::Approx(before).epsilon(2e-3));
    } else {
      CHECK(after < 0.99 * before);
    }
  }
}

/// A pile of balls that push each other stays in a closed mesh.
template <class Space>
void check_pile(Space const& space, std::size_t steps, std::size_t n) {
  using simulation = collide::simulation<meets_mesh<Space>, sphere_contact, gravity, bounce, friction>;
  double const radius = 0.1;
  world<float> w;
  add_cube(w, 1, 6);
  w.radius = static_cast<float>(radius);
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> uniform(-0.02, 0.02);
  for (std::size_t i = 0; i < n; ++i)
    w.particle(-0.8 + 0.22 * double(i % 8) + uniform(engine), -0.8 + 0.22 * double(i / 8 % 8) + uniform(engine),
               -0.8 + 0.22 * double(i / 64) + uniform(engine));
  running<simulation> made(space, w, sphere_contact::from_restitution(0.5, 0.02, radius, 1000, 0.5), gravity{},
                           bounce{0.3}, friction{0.5, 0.5});
  double worst = -1;
  for (int i = 0; i < 10; ++i) {
    made.simulation.steps(steps / 10, 1e-3f);
    worst = std::max(worst, excess(made.positions(), 1, radius));
  }
  CHECK(worst <= 1e-5);
  CHECK(kinetic_energy(made.velocities()) / double(n) < 1e-4);  // and comes to rest
  double top = -1;
  for (std::size_t i = 0; i < n; ++i) top = std::max(top, double(made.positions()[3 * i + 2]));
  CHECK(top > -0.8);  // as a pile, not in one layer
}

/// The same bits with any number of threads, with spheres that meet.
template <class Space, class Other>
void check_meeting_determinism(Space const& space, Other const& other) {
  auto const run = [](auto const& there) {
    using space_type = std::decay_t<decltype(there)>;
    using simulation =
        collide::simulation<meets_mesh<space_type>, sphere_contact, gravity, bounce, friction, collide::spin>;
    auto const w = crowd<float>(600, 1, 0.08, 2, 11);
    running<simulation> made(there, w, sphere_contact::from_restitution(0.6, 0.02, 0.08, 1000, 0.5), gravity{},
                             bounce{0.5}, friction{0.5, 0.5}, collide::spin{});
    made.simulation.steps(200, 1e-3f);
    return std::make_pair(made.positions(), made.simulation.template to_host<angular_velocity>());
  };
  auto const first = run(space);
  CHECK((run(space) == first));
  CHECK((run(other) == first));
}

/// A particle at rest falls asleep, where it is, and wakes up when it is hit or when the mesh changes.
template <class Space>
void check_sleep(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, collide::sleep, sphere_contact, gravity, drag, bounce>;
  static_assert(simulation::bytes_per_particle == 26, "two bytes more");
  world<float> w;
  add_floor(w, 4, 8);
  w.radius = 0.1f;
  w.particle(0, 0, 0.15);
  w.particle(0.05, 0, 3);
  running<simulation> made(space, w, collide::sleep{0.02, 100}, sphere_contact::from_restitution(0.5, 0.01, 0.1, 1000),
                           gravity{}, drag{2, 0}, bounce{0.3});
  auto const asleep = [&](std::size_t i) { return made.simulation.template to_host<slow_steps>()[i] >= 100; };
  made.simulation.steps(600, 5e-4f);
  CHECK(asleep(0));
  CHECK_FALSE(asleep(1));
  auto const before = made.positions();
  made.simulation.steps(200, 5e-4f);
  auto after = made.positions();
  for (std::size_t k = 0; k < 3; ++k) CHECK(after[k] == before[k]);
  made.simulation.steps(2000, 5e-4f);  // the other one comes down
  after = made.positions();
  CHECK(after[0] < -0.02f);
  made.simulation.steps(10000, 5e-4f);
  CHECK(asleep(0));
  CHECK(asleep(1));
  made.simulation.set_mesh({});
  made.simulation.steps(200, 5e-4f);
  CHECK(made.positions()[2] < 0.06f);
}

/// One of a row that sleeps is woken by what falls on it, whether that has the first number or the last; others, at the
/// ends, sleep on.
template <class Space>
void check_sleep_in_a_row(Space const& space) {
  for (bool const first : {false, true}) {
    world<float> w;
    add_floor(w, 4, 8);
    w.radius = 0.1f;
    if (first) w.particle(0.05, 0, 3);
    for (int k = 0; k < 5; ++k) w.particle(0.201 * (k - 2), 0, 0.11);
    if (!first) w.particle(0.05, 0, 3);
    running<collide::simulation<meets_mesh<Space>, collide::sleep, sphere_contact, gravity, drag, bounce>> made(
        space, w, collide::sleep{0.02, 100}, sphere_contact::from_restitution(0.5, 0.01, 0.1, 1000), gravity{},
        drag{2, 0}, bounce{0.3});
    auto const slow_of = [&] { return made.simulation.template to_host<slow_steps>(); };
    std::size_t const row = first ? 1 : 0;
    made.simulation.steps(800, 5e-4f);
    for (std::size_t i = row; i < row + 5; ++i) CHECK(slow_of()[i] >= 100);
    bool is_woken = false;
    for (int k = 0; k < 100 && !is_woken; ++k) {
      made.simulation.steps(20, 5e-4f);
      is_woken = slow_of()[row + 2] < 100;
      CHECK(slow_of()[row] >= 100);
      CHECK(slow_of()[row + 4] >= 100);
    }
    CHECK(is_woken);
  }
}

/// A particle that sticks stays where it is until forces are too strong.
template <class NarrowPhase, class Space>
void check_stick(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase>, gravity, bounce, collide::adhesion>;
  world<float> w;
  add_floor(w, 4, 8);
  w.radius = 0.1f;
  w.particle(0.1, 0.2, 0.5, 0.3, 0, 2);
  auto const run = [&](double strength, gravity const& g, double capture = 100) {
    running<simulation> made(space, w, gravity{0, 0, -9.81}, bounce{0.5}, collide::adhesion{strength, capture});
    made.simulation.steps(2000, 1e-3f);
    auto const at = made.positions();
    made.simulation.template effect<gravity>() = g;
    made.simulation.steps(1000, 1e-3f);
    auto const x = made.positions();
    return std::array<float, 3>{x[0] - at[0], x[1] - at[1], x[2] - at[2]};
  };
  for (double const strength : {5.0, 20.0}) {
    auto const wall = run(strength, {9.81, 0, 0}), ceiling = run(strength, {0, 0, 9.81});
    if (strength > 9.81) {
      for (float moved : wall) CHECK(moved == 0);
      for (float moved : ceiling) CHECK(moved == 0);
    } else {
      CHECK(wall[0] == doctest::Approx(9.81 / 2).epsilon(0.02));
      CHECK(ceiling[2] == doctest::Approx(9.81 / 2).epsilon(0.02));
    }
  }
  CHECK(std::abs(run(5, {4, 0, -8})[0]) < 1e-4f);        // a slope that pulls less along than it holds
  CHECK(std::abs(run(20, {0, 0, -9.81}, 0)[0]) > 0.1f);  // too fast to be captured: slides on
  for (double const restitution : {0.0, 0.1, 0.5}) {
    for (double const speed : {0.5, 0.9, 2.0, 5.0}) {
      world<float> one;
      add_floor(one, 4, 8);
      one.radius = 0.1f;
      one.particle(0.1, 0.2, 0.105, 0.6 * speed, 0, -0.8 * speed);
      running<simulation> made(space, one, gravity{0, 0, 0}, bounce{restitution}, collide::adhesion{20, 1});
      made.simulation.steps(40, 1e-3f);
      CHECK((made.velocities()[0] == 0) == (speed <= 1));
      CHECK((made.simulation.template to_host<adhered>()[0] == 1) == (speed <= 1));
      one.velocities = {0, 0, float(-speed)};  // and stays down, if it does not rebound
      made.place(one);
      made.simulation.template effect<gravity>().z = -9.81;
      made.simulation.steps(40, 1e-3f);
      CHECK((made.simulation.template to_host<adhered>()[0] == 1) == (speed <= 1));
    }
  }
}

/// Balls that jump in a box for 20 time units: the energy, in which each velocity is that of the middle of a step, as
/// the integrator has it.
template <class S, class Integrator, class Space>
void check_elastic_walls(Space const& space, S dt) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Integrator, gravity, collide::box_walls>;
  double const g = 9.81, late = Integrator::kick_after == 0 ? -g * double(dt) / 2 : 0;
  world<S> w;
  w.radius = S(0.1);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-0.8, 0.8);
  for (int i = 0; i < 20; ++i) {
    w.particle(uniform(engine), uniform(engine), uniform(engine), 2 * uniform(engine), uniform(engine),
               uniform(engine));
  }
  running<simulation> made(space, w, Integrator{}, gravity{0, 0, -g}, collide::box_walls{{-1, -1, -1}, {1, 1, 9}, 1});
  auto const energy = [&] {
    double sum = kinetic_energy(made.velocities());
    auto const x = made.positions(), v = made.velocities();
    for (std::size_t i = 2; i < x.size(); i += 3) sum += g * (double(x[i]) + 0.9) + late * double(v[i]);
    return sum;
  };
  double const before = energy();
  made.simulation.steps(static_cast<std::size_t>(20 / double(dt)), dt);
  CHECK(energy() == doctest::Approx(before).epsilon(sizeof(S) == 4 ? 2e-4 : 1e-6));
}

/// Without forces a ball is where a mirror image goes on; with some it comes to rest, and keeps its bits.
template <class S, class Integrator, class Space>
void check_walls(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Integrator, gravity, collide::box_walls>;
  world<S> w;
  w.radius = S(0.125);
  w.particle(0.25, 0, 0, 0.75, 0, -0.5);
  running<simulation> made(space, w, Integrator{}, gravity{0, 0, 0}, collide::box_walls{{-1, -1, -1}, {1, 1, 1}, 1});
  made.simulation.steps(1000, S(0.03125));
  double const far = std::fmod(0.25 + 0.875 + 0.75 * 31.25, 3.5);  // the box is 1.75 wide for its centre
  CHECK(made.positions()[0] == doctest::Approx((far < 1.75 ? far : 3.5 - far) - 0.875).epsilon(1e-4));
  made.simulation.template effect<gravity>().z = -9.81;
  made.simulation.template effect<collide::box_walls>().restitution = 0.5;
  made.simulation.steps(1000, S(0.03125));
  auto const x = made.positions(), v = made.velocities();
  CHECK(x[2] == S(-0.875));
  CHECK(v[2] == 0);
  made.simulation.steps(100, S(0.03125));
  CHECK(made.positions()[2] == x[2]);
}

/// One step of a particle in a box that repeats, along x: it is at x modulo the length, and in the box.
template <class S, class Space>
void check_periodic(Space const& space, double start, double by, double lower, double upper) {
  world<S> w;
  w.particle(start, lower, lower, by, 0, 0);
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::periodic_box>;
  running<simulation> made(space, w, collide::periodic_box{{lower, lower, lower}, {upper, upper, upper}});
  made.simulation.step(S(1));
  S const low = S(lower), high = S(upper), x = made.positions()[0], moved = S(start) + S(by);
  double const length = double(high) - double(low),
               whole = std::fmod(std::fmod(double(moved), length) - std::fmod(double(low), length), length);
  CAPTURE(moved);
  CHECK(x >= low);
  CHECK(x < high);
  double const error = std::abs(double(x) - double(low) - (whole < 0 ? whole + length : whole));
  double const unit = double(std::numeric_limits<S>::epsilon()) * std::max(std::abs(lower), std::abs(upper));
  CHECK(std::min(error, length - error) <= unit);
}

template <class S, class Space>
void check_periodic(Space const& space) {
  for (double const lower : {0.0, -0.5, 100.0, -1.0}) {
    for (double const by : {-7.25, -1.5, -1e-9, -1e-18, 0.0, 0.75, 1.0, 3.75, 1e3, 1e6, -1e6, 1e30}) {
      check_periodic<S>(space, lower + 0.25, by, lower, lower + 1);
      check_periodic<S>(space, lower, by, lower, lower + 1);
      check_periodic<S>(space, lower, by, lower, lower + 0.7);
    }
  }
}

template <class Space>
void check_bounds(Space const& space) {
  world<float> w;
  w.radius = 0.1f;
  w.particle(0, 0, 1, 3, 2, 0);
  using simulation = collide::simulation<meets_mesh<Space>, gravity, collide::box_walls>;
  collide::box_walls box;
  box.lower[0] = box.lower[1] = -1, box.upper[0] = box.upper[1] = 1, box.lower[2] = 0;
  running<simulation> made(space, w, gravity{}, box);
  bool inside = true;
  for (int i = 0; i < 100; ++i) {
    made.simulation.steps(20, 1e-3f);
    auto const x = made.positions();
    inside = inside && std::abs(x[0]) <= 0.9f && std::abs(x[1]) <= 0.9f && x[2] >= 0.1f;
  }
  CHECK(inside);
  CHECK(made.positions()[2] == doctest::Approx(0.1).epsilon(0.01));

  running<collide::simulation<meets_mesh<Space>, collide::periodic_box>> around(
      space, w, collide::periodic_box{{-1, -1, 0}, {1, 1, 2}});
  around.simulation.steps(1000, 1e-3f);
  auto const x = around.positions();
  CHECK(x[0] == doctest::Approx(-1).epsilon(1e-3));  // 3 on, 4 and a half rounds... modulo 2 from 0 on
  CHECK(x[1] == doctest::Approx(0).scale(1).epsilon(1e-3));
  CHECK(x[2] == 1);
  check_periodic<float>(space);
  check_periodic<double>(space);
  using euler = collide::semi_implicit_euler;
  using verlet = collide::velocity_verlet;
  for (double const step : {1e-3, 5e-3}) {
    check_elastic_walls<float, euler>(space, float(step));
    check_elastic_walls<float, verlet>(space, float(step));
    check_elastic_walls<double, euler>(space, step);
    check_elastic_walls<double, verlet>(space, step);
  }
  check_walls<float, euler>(space);
  check_walls<float, verlet>(space);
  check_walls<double, euler>(space);
  check_walls<double, verlet>(space);
}

template <class Space>
std::size_t count_present(std::vector<std::uint8_t> const& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
}

template <class NarrowPhase, class Space>
void check_absorb(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, NarrowPhase>, gravity, collide::absorb, collide::absorbing_box>;
  static_assert(simulation::bytes_per_particle == 25, "a byte more");
  world<float> w;
  add_floor(w, 4, 8);
  w.radius = 0.1f;
  for (int i = 0; i < 30; ++i) w.particle(-2 + 0.1 * i, 0, i < 20 ? 1 : 100);
  w.particle(50, 0, 1);
  running<simulation> made(space, w, gravity{}, collide::absorb{}, collide::absorbing_box{{40, -1, -2}, {60, 1, -1}});
  made.simulation.steps(1000, 1e-3f);
  auto const flags = made.simulation.template to_host<alive>();
  for (std::size_t i = 0; i < flags.size(); ++i) CHECK(int(flags[i]) == (i < 20 || i == 30 ? 0 : 1));
  auto const x = made.positions();
  CHECK(x[2] == doctest::Approx(0.1).epsilon(0.1));  // where it touched
  CHECK(x[3 * 30 + 2] == doctest::Approx(-1).epsilon(0.02));
}

template <class Space>
void check_emit(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, collide::emit, gravity>;
  collide::nozzle const nozzle{{1, 2, 3}, 0.5, {0, 0, 4}, 1};
  auto const run = [&](std::size_t steps, std::size_t room) {
    simulation made(space, collide::emit{1000, nozzle}, gravity{});
    placed<float> const centres(space, std::vector<float>{7, 7, 7, 8, 8, 8});
    made.set(collide::spheres_xyz(centres.data(), 2, 0.1f), nullptr, room);
    made.steps(steps, 0.00175f);
    return std::make_tuple(made.template to_host<alive>(), made.template to_host<position>(),
                           made.template to_host<velocity>());
  };
  auto const few = run(40, 100);  // 0.07 time units
  CHECK(count_present<Space>(std::get<0>(few)) == 2 + 70);
  CHECK((run(40, 100) == few));
  auto const& x = std::get<1>(few);
  CHECK(x[0] == 7);
  bool spread = false, near = true;
  for (std::size_t i = 2; i < 72; ++i) {
    near = near && std::abs(x[3 * i] - 1) <= 0.5f + 0.08f && std::abs(x[3 * i + 1] - 2) <= 0.5f + 0.08f;
    spread = spread || std::abs(x[3 * i] - x[6]) > 0.3f;
  }
  CHECK(near);
  CHECK(spread);
  auto const many = run(200, 100);  // 350 in 98 places: the oldest made room
  CHECK(count_present<Space>(std::get<0>(many)) == 100);
  for (std::size_t i = 2; i < 100; ++i)
    CHECK(std::get<2>(many)[3 * i + 2] > 5 - 2 - 9.81f * 0.1f - 0.1f);  // all are young
}

/// A source keeps the number of its particles when its rate changes, and the oldest while there is room.
template <class S, class Space>
void check_rates(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::emit>;
  auto const make = [&](double rate, std::size_t room) {
    simulation made(space, collide::emit{rate, {}});
    made.set(collide::spheres_xyz(static_cast<S const*>(nullptr), 0, S(0.1)), nullptr, room);
    return made;
  };
  auto const present = [](simulation const& made) { return count_present<Space>(made.template to_host<alive>()); };
  for (double const rate : {50.0, 100.0, 200.0, 0.0}) {
    auto made = make(100, 300);
    made.steps(128, S(1) / 128);
    CHECK(present(made) == 100);
    made.template effect<collide::emit>().rate = rate;
    made.steps(128, S(1) / 128);
    CHECK(present(made) == 100 + static_cast<std::size_t>(rate));
    made.set(collide::spheres_xyz(static_cast<S const*>(nullptr), 0, S(0.1)), nullptr, 300);
    made.template effect<collide::emit>().rate = 64;
    made.steps(64, S(1) / 128);
    CHECK(present(made) == 32);  // begins anew
  }
  auto made = make(100, 110);
  made.steps(128, S(1) / 128);
  made.template effect<collide::emit>().source.position[0] = 7;
  made.template effect<collide::emit>().rate = 110;
  auto const fresh = [&] {
    auto const x = made.template to_host<position>();
    auto const there = made.template to_host<alive>();
    std::size_t n = 0;
    for (std::size_t i = 0; i < there.size(); ++i) n += there[i] == 1 && x[3 * i] == S(7);
    return n;
  };
  made.steps(8, S(1) / 128);
  CHECK(fresh() == 6);  // of 6.875
  CHECK(present(made) == 106);
  made.steps(8, S(1) / 128);
  CHECK(fresh() == 13);
  CHECK(present(made) == 110);
  made.step(S(1e6));  // more than there are places
  CHECK(fresh() == 110);
  auto often = make(10, 2000);  // 0.1 is no sum of powers of two
  if (sizeof(S) == 8) {
    often.steps(1000, S(0.01));
    CHECK(present(often) == 100);
  }
}

/// Particles of a source have the radius that it is given, or that of all; none is an error.
template <class Space>
void check_source_radius(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, collide::emit, gravity, bounce, collide::polydisperse>;
  world<float> w;
  w.radius = 0.125f;
  add_floor(w, 4, 8);
  for (int i = 0; i < 4; ++i) w.particle(-1 + i, 1, 1);
  collide::nozzle const above{{0.3, 0.2, 2}, 0.1, {0, 0, 0}, 0};
  auto const lowest = [&](float own, std::vector<float> const& radii) {
    world<float> here = w;
    here.radii = radii;
    running<simulation> made(space, w, collide::emit{20, above, own}, gravity{}, bounce{0}, collide::polydisperse{});
    made.place(here, 24);
    made.simulation.steps(1500, 1e-3f);
    auto const x = made.positions(), r = made.simulation.template to_host<collide::radius>();
    float z = 9;
    for (std::size_t i = 4; i < 24; ++i) {
      z = std::min(z, x[3 * i + 2]);
      CHECK(r[i] == (own > 0 ? own : 0.125f));
    }
    return z;
  };
  CHECK(lowest(0.25f, {}) == doctest::Approx(0.25));
  CHECK(lowest(0, {}) == doctest::Approx(0.125));
  CHECK(lowest(0.3f, {0.1f, 0.1f, 0.2f, 0.1f}) == doctest::Approx(0.3));
  CHECK_THROWS_WITH_AS(lowest(0, {0.1f, 0.1f, 0.2f, 0.1f}),
                       "collide: emit: the radii differ: give the source a radius, before set", collide::error);
  collide::simulation<meets_mesh<Space>, collide::emit> of_one(space, collide::emit{20, above, 0.25});
  CHECK_THROWS_WITH_AS(of_one.set(collide::spheres_xyz<float>(nullptr, 0, 0.1f), nullptr, 9),
                       "collide: emit: a source with a radius of its own needs polydisperse in the scene",
                       collide::error);
}

}  // namespace tests
