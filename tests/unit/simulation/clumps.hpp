/// Clumps, against closed forms and single spheres; instantiated by test_clumps.cpp and test_clumps_cuda.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <sstream>

#include <collide/effects/absorb.hpp>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/clumps.hpp>
#include <collide/effects/contact_forces.hpp>
#include <collide/effects/contact_work.hpp>
#include <collide/effects/drag.hpp>
#include <collide/effects/emit.hpp>
#include <collide/effects/external_forces.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/mass_flow.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/simulation/checkpoint.hpp>
#include <collide/simulation/energy.hpp>
#include <collide/simulation/place_clumps.hpp>
#include <collide/simulation/stress.hpp>

#include "simulation/simulation.hpp"

namespace tests {

using collide::clump_shape;
using collide::clumps;
using collide::granular_contact;
using collide::gravity;
using collide::hertz;
using collide::linear;
using collide::mindlin;
using collide::none;
using collide::placed_clump;
using collide::velocity_verlet;
using vector = collide::vec3<double>;

using ball = collide::sphere<double>;

/// A simulation of clumps and a mesh.
template <class Space, class S, class... Effect>
class clumps_in {
 public:
  using simulation_type =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, velocity_verlet, Effect..., clumps>;

  explicit clumps_in(Space space, world<S> const& w, Effect... effects)
      : made(space, velocity_verlet{}, effects..., clumps{}), corners_(space, w.corners) {
    made.set_mesh(collide::triangle_soup(corners_.data(), corners_.size() / 9));
  }

  template <class Column>
  vector read(std::size_t i) const {
    auto const all = made.template to_host<Column>();
    return {double(all[3 * i]), double(all[3 * i + 1]), double(all[3 * i + 2])};
  }
  vector centre(std::size_t i) const { return read<collide::clump_centre>(i); }
  vector speed(std::size_t i) const { return read<collide::clump_velocity>(i); }
  vector turning(std::size_t i) const { return read<collide::angular_velocity>(i); }

  simulation_type made;

 private:
  placed<S> corners_;
};

template <class Simulation>
auto state_of_clumps(Simulation const& of) {
  return std::tuple(of.template to_host<position>(), of.template to_host<velocity>(),
                    of.template to_host<collide::angular_velocity>(), of.template to_host<collide::clump_centre>(),
                    of.template to_host<collide::clump_momentum>(), of.template to_host<collide::clump_rotation>());
}

inline clump_shape dumbbell(double apart, double radius) {
  return collide::shape_of_clump({ball{{0, 0, 0}, radius}, ball{{apart, 0, 0}, radius}});
}
/// Spheres of which several overlap, without any symmetry.
inline clump_shape potato() {
  return collide::shape_of_clump({ball{{0, 0, 0}, 0.5}, ball{{0.6, 0.2, 0}, 0.4}, ball{{0.3, 0.7, 0.3}, 0.3}});
}

inline placed_clump clump_at(double x, double y, double z) {
  placed_clump c;
  c.at.position[0] = x, c.at.position[1] = y, c.at.position[2] = z;
  return c;
}

template <class Law>
Law law_of(double young, double restitution, double friction, double rolling = 0) {
  return Law{collide::one_material({young, 0.25, 1000}, {restitution, friction, rolling})};
}

// ---- shapes

/// Volume and moments of a union are those of closed forms, and do not depend on how it lies in its frame; spheres
/// begin where they were given.
template <class Space>
void check_shapes(Space const& space) {
  double const turn = 3.141592653589793, r = 0.5, d = 0.6, lens = turn * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12;
  CHECK(dumbbell(d, r).volume == doctest::Approx(8 * turn / 3 * r * r * r - lens).epsilon(1e-6));
  auto const within = collide::detail::moments_of_union({ball{{1, 2, 3}, r}}, 2000);
  CHECK(within.second[1][2] / within.volume == doctest::Approx(6).epsilon(1e-6));
  CHECK(within.second[0][0] / within.volume == doctest::Approx(1 + r * r / 5).epsilon(1e-6));
  double q[4];
  collide::turn_at_random(q, 9);
  std::vector<ball> turned{ball{{0, 0, 0}, 0.5}, ball{{0.6, 0.2, 0}, 0.4}, ball{{0.3, 0.7, 0.3}, 0.3}};
  auto const given = turned;
  for (ball& b : turned) b.centre = collide::detail::rotated(q, b.centre);
  clump_shape a = potato(), b = collide::shape_of_clump(turned);
  CHECK(a.volume == doctest::Approx(b.volume).epsilon(2e-6));
  std::sort(a.inertia, a.inertia + 3);
  std::sort(b.inertia, b.inertia + 3);
  for (int k = 0; k < 3; ++k) CHECK(a.inertia[k] == doctest::Approx(b.inertia[k]).epsilon(2e-6));
  CHECK_THROWS_WITH_AS(collide::shape_of_clump({}), doctest::Contains("clump_shape"), collide::error);
  a.inertia[2] = 1;
  CHECK_THROWS_WITH_AS(a.check(), doctest::Contains("moments of inertia"), collide::error);

  clumps_in<Space, double, granular_contact<hertz, mindlin>, collide::polydisperse> one(
      space, {}, law_of<granular_contact<hertz, mindlin>>(1e5, 0.5, 0.3), {});
  placed_clump c = clump_at(1, 2, 3);
  c.scale = 2;
  for (int k = 0; k < 3; ++k) c.moving.linear[k] = k + 1, c.moving.angular[k] = 2 - k;
  collide::set_clumps(one.made, {potato()}, {c});
  for (std::size_t i = 0; i < 3; ++i) {
    vector const arm = given[i].centre * 2;
    CHECK((one.template read<position>(i) - vector(1, 2, 3) - arm).norm() < 1e-14);
    CHECK((one.template read<velocity>(i) - vector(1, 2, 3) - collide::detail::cross(vector(2, 1, 0), arm)).norm() <
          1e-13);
  }
  c.at.rotation[1] = 1;
  CHECK_THROWS_WITH_AS(collide::set_clumps(one.made, {potato()}, {c}), doctest::Contains("quaternion"), collide::error);
}

// ---- the motion of one

/// A free asymmetric top keeps its angular momentum to the bit, its energy to what a step makes of it, and the length
/// of its quaternion, though its spheres overlap.
template <class S, class Space>
void check_free_top(Space const& space, std::size_t steps) {
  clumps_in<Space, S, granular_contact<hertz, mindlin>, collide::polydisperse> one(
      space, {}, law_of<granular_contact<hertz, mindlin>>(sizeof(S) == 4 ? 1e4 : 1e7, 0.5, 0.3), {});
  placed_clump c = clump_at(1, 2, 3);
  collide::turn_at_random(c.at.rotation, 5);
  c.moving.angular[0] = 0.3, c.moving.angular[1] = 1, c.moving.angular[2] = 0.2;
  collide::set_clumps(one.made, {potato()}, {c});
  double const dt = sizeof(S) == 4 ? 0x1p-8 : 0x1p-12;
  auto const momentum = one.template read<collide::clump_momentum>(0);
  auto const energy = [&] { return momentum.dot(one.turning(0)); };
  double const before = energy();
  double least = before, most = before;
  for (int look = 0; look < 100; ++look) {
    one.made.steps(steps / 100, S(dt));
    least = std::min(least, energy()), most = std::max(most, energy());
  }
  CHECK(one.template read<collide::clump_momentum>(0) == momentum);
  CHECK(most - least < before * (sizeof(S) == 4 ? 1e-4 : 3e-8));
  CHECK(most > least);
  auto const q = one.made.template to_host<collide::clump_rotation>();
  double squared = 0;
  for (int k = 0; k < 4; ++k) squared += double(q[std::size_t(k)]) * double(q[std::size_t(k)]);
  CHECK(squared == doctest::Approx(1).epsilon(sizeof(S) == 4 ? 2e-7 : 5e-16));
  // the spheres are where they were in the body
  auto const shape = potato();
  double const apart = (shape.spheres[0].centre - shape.spheres[2].centre).norm();
  CHECK((one.template read<position>(0) - one.template read<position>(2)).norm() ==
        doctest::Approx(apart).epsilon(sizeof(S) == 4 ? 1e-6 : 1e-14));
}

/// Where a top is after a time goes with the square of the step.
template <class Space>
void check_order_of_tops(Space const& space) {
  clumps_in<Space, double, granular_contact<hertz, mindlin>, collide::polydisperse> one(
      space, {}, law_of<granular_contact<hertz, mindlin>>(1e5, 0.5, 0.3), {});
  placed_clump c = clump_at(0, 0, 0);
  c.moving.angular[0] = 3, c.moving.angular[1] = 5, c.moving.angular[2] = 4;
  auto const end = [&](double dt) {
    collide::set_clumps(one.made, {potato()}, {c});
    one.made.steps(static_cast<std::size_t>(1 / dt), dt);
    return one.template read<position>(1);
  };
  vector const exact = end(0x1p-14);
  double const coarse = (end(0x1p-9) - exact).norm(), fine = (end(0x1p-10) - exact).norm();
  CHECK(coarse / fine == doctest::Approx(4).epsilon(0.02));
}

/// A clump of one sphere has the bits of a sphere; one with a small sphere in the middle of a large one, which touches
/// nothing, and with that one's mass and moments, goes through all of a clump's arithmetic and comes to the same.
template <class S, class Space>
void check_sphere_as_clump(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  auto const by = law_of<law>(1e6, 0.5, 0.3, 0.05);
  world<S> w;
  w.radius = S(0.1);
  add_floor(w, 2, 3);
  w.particle(0, 0, 0.15, 1, 0.3, -0.5);
  w.particle(0.2, 0.1, 0.4, 0, 0, -1);
  collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, velocity_verlet, gravity, law> spheres(
      space, velocity_verlet{}, gravity{}, by);
  placed<S> const corners(space, w.corners), centres(space, w.centres), velocities(space, w.velocities);
  spheres.set_mesh(collide::triangle_soup(corners.data(), corners.size() / 9));
  spheres.set(collide::spheres_xyz(centres.data(), 2, w.radius), velocities.data());
  auto const placed_as = [&](clumps_in<Space, S, gravity, law>& to, clump_shape const& shape) {
    std::vector<placed_clump> all;
    for (std::size_t i = 0; i < 2; ++i) {
      placed_clump c;
      for (std::size_t k = 0; k < 3; ++k) {
        c.at.position[k] = double(w.centres[3 * i + k]);
        c.moving.linear[k] = double(w.velocities[3 * i + k]);
      }
      all.push_back(c);
    }
    collide::set_clumps(to.made, {shape}, all);
  };
  clump_shape const one = collide::shape_of_clump({ball{{0, 0, 0}, double(w.radius)}});
  clumps_in<Space, S, gravity, law> alike(space, w, gravity{}, by);
  placed_as(alike, one);
  S const dt = S(2e-4);
  spheres.steps(3000, dt);
  alike.made.steps(3000, dt);
  CHECK(alike.made.template to_host<position>() == spheres.template to_host<position>());
  CHECK(alike.made.template to_host<velocity>() == spheres.template to_host<velocity>());
  CHECK(alike.made.template to_host<collide::angular_velocity>() ==
        spheres.template to_host<collide::angular_velocity>());
}

/// A ball with a small one in its middle, which touches nothing, and its mass and moments: it goes through all of a
/// clump's arithmetic, and comes to where the ball comes.
template <class Space>
void check_ball_with_core(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  using polydisperse = collide::polydisperse;
  auto const by = law_of<law>(1e6, 0.5, 0.3, 0.05);
  world<double> w;
  add_floor(w, 2, 3);
  std::vector<placed_clump> all{clump_at(0, 0, 0.15), clump_at(0.2, 0.1, 0.4)};
  all[0].moving.linear[0] = 1, all[0].moving.linear[2] = -0.5, all[1].moving.linear[2] = -1;
  all[0].moving.angular[1] = 4, all[1].moving.angular[0] = -7;
  collide::turn_at_random(all[0].at.rotation, 1);
  clump_shape const one = collide::shape_of_clump({ball{{0, 0, 0}, 0.1}});
  clump_shape cored = one;
  cored.spheres.push_back({{0, 0, 0}, 0.02});
  clumps_in<Space, double, gravity, law, polydisperse> balls(space, w, gravity{}, by, {}),
      both(space, w, gravity{}, by, {});
  collide::set_clumps(balls.made, {one}, all);
  collide::set_clumps(both.made, {cored}, all);
  balls.made.steps(3000, 2e-4);
  both.made.steps(3000, 2e-4);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK((balls.template read<position>(i) - both.template read<position>(2 * i)).norm() < 1e-11);
    CHECK((balls.template read<velocity>(i) - both.template read<velocity>(2 * i)).norm() < 1e-10);
    CHECK((balls.turning(i) - both.turning(2 * i)).norm() < 1e-9);
    CHECK(balls.turning(i).norm() > 1);
  }
}

// ---- contact

/// An elastic dumbbell that hits a smooth floor aslant, with one ball: the impulse J = 2 v / (1/M + a^2 / I), for the
/// arm a of the force.
template <class Space>
void check_dumbbell_impact(Space const& space) {
  using law = granular_contact<hertz>;
  world<double> w;
  add_floor(w, 3, 1);
  clump_shape const shape = dumbbell(0.5, 0.1);
  double const angle = 0.6, v = 0.5, offset = 0.25;
  placed_clump c = clump_at(0, 0, 0.101);
  c.at.rotation[0] = std::cos(angle / 2), c.at.rotation[2] = -std::sin(angle / 2);  // the second ball is above
  c.moving.linear[2] = -v;
  clumps_in<Space, double, law> one(space, w, law_of<law>(1e10, 1, 0));
  collide::set_clumps(one.made, {shape}, {c});
  CHECK(shape.inertia[1] == doctest::Approx(0.25 * 0.25 + 0.4 * 0.01).epsilon(1e-14));
  one.made.steps(12000, 1e-6);
  double const arm = offset * std::cos(angle), i = shape.inertia[1], impulse = 2 * v / (1 + arm * arm / i);
  CHECK(one.speed(0).z() == doctest::Approx(impulse - v).epsilon(1e-3));
  CHECK(one.turning(0).y() == doctest::Approx(arm * impulse / i).epsilon(1e-3));
  CHECK(std::abs(one.turning(0).y()) > 1);
  CHECK(std::abs(one.turning(0).x()) < 1e-9);
}

/// A rod that lies across a slope, given by the direction of gravity, rolls down with g sin / (1 + I / (M R^2)), and
/// slides with g (sin - mu cos) where friction is small.
template <class Space>
void check_rod_on_slope(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  world<double> w;
  add_floor(w, 3, 2);
  std::vector<ball> spheres;
  for (int i = 0; i < 5; ++i) spheres.push_back({{0, 0.12 * i, 0}, 0.1});
  clump_shape const shape = collide::shape_of_clump(spheres);
  double const along = *std::min_element(shape.inertia, shape.inertia + 3), slope = 0.3;
  for (double const friction : {0.5, 0.05}) {
    gravity const g{9.81 * std::sin(slope), 0, -9.81 * std::cos(slope)};
    clumps_in<Space, double, gravity, law> one(space, w, g, law_of<law>(1e8, 0.3, friction));
    collide::set_clumps(one.made, {shape}, {clump_at(-1, -0.24, 0.1)});
    one.made.steps(2000, 1e-4);
    double const from = one.speed(0).x();
    one.made.steps(4000, 1e-4);
    double const rolls = 9.81 * std::sin(slope) / (1 + along / 0.01),
                 slides = 9.81 * (std::sin(slope) - friction * std::cos(slope));
    CHECK((one.speed(0).x() - from) / 0.4 == doctest::Approx(std::max(rolls, slides)).epsilon(1e-3));
    CHECK(std::abs(one.speed(0).y()) < 1e-6);
    if (friction == 0.5) CHECK(one.turning(0).y() * 0.1 == doctest::Approx(one.speed(0).x()).epsilon(2e-3));
  }
}

/// Dashpots know the mass of a clump: one of eight times its ball's mass leaves a floor, and another one of half of
/// that, with the restitution of the material.
template <class Space>
void check_restitution_of_clumps(Space const& space) {
  using law = granular_contact<linear>;
  world<double> w;
  add_floor(w, 3, 1);
  clump_shape heavy = collide::shape_of_clump({ball{{0, 0, 0}, 0.1}});
  heavy.spheres.push_back({{0, 0, 0}, 0.02});
  clump_shape half = heavy;
  heavy.volume *= 8, half.volume *= 4;
  auto by = law_of<law>(1e7, 0.4, 0);
  by.normal.stiffness = 1e6;
  clumps_in<Space, double, law, collide::polydisperse> some(space, w, by, {});
  std::vector<placed_clump> all{clump_at(0, 0, 0.11), clump_at(-1, 0, 1), clump_at(-0.79, 0, 1)};
  all[2].shape = 1;
  all[0].moving.linear[2] = -1, all[1].moving.linear[0] = 2;
  collide::set_clumps(some.made, {heavy, half}, all);
  some.made.steps(20000, 4e-6);
  CHECK(some.speed(0).z() == doctest::Approx(0.4).epsilon(1e-3));
  double const first = some.speed(2).x(), second = some.speed(4).x();
  CHECK(first + second / 2 == doctest::Approx(2).epsilon(1e-12));
  CHECK(second - first == doctest::Approx(0.8).epsilon(1e-3));
}

/// Forces on the spheres of a clump add up, and turn it.
template <class S, class Space>
void check_forces_on_clumps(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  S const dt = S(1e-3);
  clumps_in<Space, S, law, collide::external_forces<>> some(space, {}, law_of<law>(1e5, 0.5, 0.3), {{1000}});
  clump_shape const shape = dumbbell(0.5, 0.1);
  collide::set_clumps(some.made, {shape}, {clump_at(0, 0, 0), clump_at(0, 3, 0)});
  double const mass = 1000 * shape.volume;
  std::vector<S> forces(12, S(0));
  forces[2] = S(3 * mass), forces[7] = S(mass), forces[8] = S(-mass), forces[10] = S(mass), forces[11] = S(mass);
  placed<S> const there(space, forces);
  some.made.template assign<collide::external_force>(there.data());
  for (int k = 0; k < 10; ++k) some.made.step(dt);
  double const close = sizeof(S) == 4 ? 1e-4 : 1e-6, time = 0.01;
  CHECK(some.speed(0).z() == doctest::Approx(3 * time).epsilon(sizeof(S) == 4 ? 1e-5 : 1e-12));
  CHECK(some.speed(2).y() == doctest::Approx(2 * time).epsilon(sizeof(S) == 4 ? 1e-5 : 1e-12));
  CHECK(std::abs(some.speed(2).z()) < 1e-8);
  double const arm = (some.template read<position>(0) - some.centre(0)).x(), turn = arm * 3 * time;
  CHECK(some.template read<collide::clump_momentum>(0).y() == doctest::Approx(-turn).epsilon(close));
  CHECK(some.turning(0).y() == doctest::Approx(-turn / shape.inertia[1]).epsilon(close));
  vector const across = some.template read<position>(2) - some.centre(2);
  CHECK(some.template read<collide::clump_momentum>(2).y() == doctest::Approx(2 * across.x() * time).epsilon(close));
}

/// Clumps fall through a surface, each once and with its mass, and vanish as a whole.
template <class Space>
void check_flow_of_clumps(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  collide::flow_sums sums(space, 1e-9);
  auto const through = sums.through({0, 0, 0}, {0, 0, -1}, collide::one_density{1000});
  clumps_in<Space, double, gravity, law, collide::polydisperse, collide::mass_flow<>, collide::absorbing_box> some(
      space, {}, gravity{}, law_of<law>(1e5, 0.5, 0.3), {}, through, {{-9, -9, -9}, {9, 9, -1}});
  std::vector<placed_clump> all;
  for (int i = 0; i < 6; ++i) {
    all.push_back(clump_at(3 * (i % 3), 0, 0.8 + 3 * (i / 3)));
    all.back().moving.angular[0] = i;
  }
  collide::set_clumps(some.made, {potato()}, all);
  some.made.steps(3300, 2e-4);  // 2.1 m: the lower three
  auto const flow = sums.read(space);
  CHECK(flow.particles == 3);
  CHECK(flow.mass == doctest::Approx(3 * 1000 * potato().volume).epsilon(1e-9));
  auto const there = some.made.template to_host<collide::alive>();
  for (std::size_t i = 0; i < there.size(); ++i) CHECK(int(there[i]) == int(i >= 9));
  vector const gone = some.centre(0);
  some.made.steps(100, 2e-4);
  CHECK(some.centre(0) == gone);
  CHECK(some.centre(9) != gone);
}

/// Clumps vanish as a whole in the step in which one of their spheres comes to a mesh that absorbs, or the next to it;
/// what flows through a surface above it is counted once. A scene without a sink says when.
template <class Space>
void check_sink_of_clumps(Space const& space) {
  using collide::sphere_contact;
  auto const contact = sphere_contact::from_restitution(0.5, 0.01, 0.1, 1000);
  world<double> w;
  add_floor(w, 9, 2);
  collide::flow_sums sums(space, 1e-9);
  auto const through = sums.through({0, 0, 0.9}, {0, 0, -1}, collide::one_density{1000});
  clumps_in<Space, double, gravity, sphere_contact, collide::absorb, collide::polydisperse, collide::mass_flow<>> some(
      space, w, gravity{}, contact, {}, {}, through);
  clumps_in<Space, double, gravity, sphere_contact, collide::polydisperse> free(space, {}, gravity{}, contact, {});
  std::vector<placed_clump> all;
  for (int i = 0; i < 6; ++i) {
    all.push_back(clump_at(3 * (i % 3) - 3, 0, 1.5 + 2 * (i / 3)));
    for (int k = 0; k < 3; ++k) all.back().moving.angular[k] = std::sin(5 * i + k) * 3;
  }
  collide::set_clumps(some.made, {potato()}, all);
  collide::set_clumps(free.made, {potato()}, all);
  std::vector<int> touched(6, -1), gone(6, -1);
  for (int step = 0; step < 4500; ++step) {
    some.made.step(2e-4);
    free.made.step(2e-4);
    auto const there = some.made.template to_host<collide::alive>();
    auto const x = free.made.template to_host<position>(), r = free.made.template to_host<collide::radius>();
    for (std::size_t i = 0; i < 18; ++i) {
      if (touched[i / 3] < 0 && x[3 * i + 2] < r[i]) touched[i / 3] = step;
      if (gone[i / 3] < 0 && there[i] == 0) gone[i / 3] = step;
      CHECK(int(there[i]) == int(gone[i / 3] < 0));
    }
  }
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(touched[i] > 0);
    CHECK(std::abs(gone[i] - touched[i]) <= 1);
  }
  CHECK(sums.read(space).particles == 6);
  CHECK(sums.read(space).mass == doctest::Approx(6 * 1000 * potato().volume).epsilon(1e-9));
  CHECK(collide::energy(some.made).total() == 0);
}

// ---- sleep

/// A bed of clumps and balls on a floor, and one that falls on it.
template <class S, class Space, class Sleep = collide::sleep>
struct bed_of_clumps {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  using scene =
      clumps_in<Space, S, Sleep, gravity, collide::drag, law, collide::polydisperse, collide::moving_bodies<>>;
  static constexpr double dt = 5e-4;

  static scene make(Space const& space, Sleep const& sleep) {
    world<S> w;
    add_floor(w, 2, 4);
    scene made(space, w, sleep, gravity{}, collide::drag{3, 0}, law_of<law>(2e6, 0.3, 0.5, 0.2), {}, {});
    std::vector<placed_clump> all;
    for (int i = 0; i < 10; ++i) {
      all.push_back(clump_at(0.35 * (i % 3 - 1), 0.35 * (i / 3 % 3 - 1), i < 9 ? 0.3 : 6));
      all.back().shape = std::size_t(i) % 2;
      all.back().scale = 0.3;
      collide::turn_at_random(all.back().at.rotation, std::uint64_t(i));
    }
    collide::set_clumps(made.made, {dumbbell(0.5, 0.4), potato()}, all);
    return made;
  }
  /// How many clumps sleep, of which all spheres do or none.
  static int asleep(scene const& of) {
    auto const slow = of.made.template to_host<collide::slow_steps>();
    auto const first = of.made.template to_host<collide::in_clump>();
    int n = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      CHECK(int(slow[i]) == int(slow[first[i]]));
      n += first[i] == i && slow[i] >= 50 && slow[i] < collide::detail::carried_by_moving;
    }
    return n;
  }
};

/// In place of sleep: nothing.
struct no_sleep {
  using reads = collide::columns<velocity>;
};

/// A bed of clumps comes to rest where it does without sleep, sleeps, and keeps its bits until a clump falls on it:
/// whom that hits is awake, with all its spheres.
template <class S, class Space>
void check_sleep_of_clumps(Space const& space) {
  using bed = bed_of_clumps<S, Space>;
  auto found = bed::make(space, collide::sleep{0.01, 50});
  auto awake = bed_of_clumps<S, Space, no_sleep>::make(space, {});
  S const dt = S(bed::dt);
  found.made.steps(3600, dt);
  awake.made.steps(3600, dt);
  CHECK(bed::asleep(found) == 9);
  auto const before = found.made.template to_host<position>(), other = awake.made.template to_host<position>();
  for (std::size_t i = 0; i + 9 < before.size(); ++i) CHECK(std::abs(double(before[i]) - double(other[i])) < 3e-3);
  found.made.steps(200, dt);
  auto const after = found.made.template to_host<position>();
  std::size_t const bytes = (before.size() - 9) * sizeof(S);  // without the three spheres that fall
  CHECK(std::memcmp(before.data(), after.data(), bytes) == 0);
  int least = 9;
  for (int k = 0; k < 300; ++k) {
    found.made.steps(10, dt);
    least = std::min(least, bed::asleep(found));
  }
  CHECK(least < 9);
  CHECK(std::memcmp(before.data(), found.made.template to_host<position>().data(), bytes) != 0);
  found.made.steps(6000, dt);
  CHECK(bed::asleep(found) == 10);
}

/// A clump that lies wakes as a whole, whichever of its spheres a ball falls on.
template <class Space>
void check_each_sphere_wakes(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  world<double> w;
  add_floor(w, 2, 4);
  for (double const hit : {0.0, 0.6}) {
    clumps_in<Space, double, collide::sleep, gravity, law> some(space, w, {0.01, 50}, gravity{},
                                                                law_of<law>(2e6, 0.3, 0.5, 0.2));
    placed_clump falling = clump_at(hit, 0.02, 2);
    falling.shape = 1;
    collide::set_clumps(some.made, {dumbbell(0.6, 0.1), collide::shape_of_clump({ball{{0, 0, 0}, 0.1}})},
                        {clump_at(0, 0, 0.1), falling});
    auto const slow_of = [&](std::size_t i) { return int(some.made.template to_host<collide::slow_steps>()[i]); };
    some.made.steps(1000, 5e-4);
    CHECK((slow_of(0) >= 50 && slow_of(1) >= 50 && slow_of(2) == 0));
    vector const rested = some.centre(0);
    some.made.steps(300, 5e-4);
    CHECK(slow_of(0) < 50);
    CHECK(slow_of(1) == slow_of(0));
    CHECK((some.centre(0) - rested).norm() > 1e-4);
  }
}

/// Clumps asleep on a body are woken where that begins to move, and go with it: one on the floor, and one on it.
template <class S, class Space>
void check_clumps_asleep_on_bodies(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  world<S> w;
  add_floor(w, 2, 4);
  clumps_in<Space, S, collide::sleep, gravity, law, collide::moving_bodies<collide::driven>> found(
      space, w, {0.01, 50}, gravity{}, law_of<law>(2e6, 0.3, 0.5, 0.2), {});
  placed<S> const corners(space, w.corners);
  found.made.set_mesh(collide::triangle_soup(corners.data(), corners.size() / 9), {{0, w.corners.size() / 9, {}}});
  std::vector<ball> plate;
  for (int i = 0; i < 9; ++i) plate.push_back({{0.2 * (i % 3), 0.2 * (i / 3), 0}, 0.11});
  collide::set_clumps(found.made, {collide::shape_of_clump(plate)}, {clump_at(0, 0, 0.11), clump_at(0.1, 0.1, 0.29)});
  found.made.steps(1500, S(5e-4));
  for (auto const slow : found.made.template to_host<collide::slow_steps>()) CHECK((slow >= 50 && slow < 128));
  double const low = found.centre(0).z(), high = found.centre(9).z();
  collide::body_state state;
  for (double const speed : {-0.005, -0.1, 0.005}) {
    state.moving.linear[2] = speed;
    for (int i = 0; i < 300; ++i) {
      state.at.position[2] += speed * 5e-4;
      space.copy_from_host(found.made.bodies().states(), &state, 1);
      found.made.step(S(5e-4));
      space.synchronize();
    }
    CHECK(std::abs(found.centre(0).z() - low - state.at.position[2]) < 5e-4);
    CHECK(std::abs(found.centre(9).z() - high - state.at.position[2]) < 1e-3);
  }
}

/// Clumps of spheres that overlap press with the weight of their unions when they sleep, one of them on the other, as
/// they do when they are awake.
template <class S, class Space>
void check_weight_of_sleeping_clumps(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  world<S> w;
  add_floor(w, 2, 4);
  std::vector<ball> plate;
  for (int i = 0; i < 9; ++i) plate.push_back({{0.2 * (i % 3), 0.2 * (i / 3), 0}, 0.11});
  clump_shape const shape = collide::shape_of_clump(plate);
  double const weight = 2 * 1000 * shape.volume * 9.81, dt = 5e-4;
  collide::reaction_sums sums(space, 1, weight * 1e-12);
  clumps_in<Space, S, collide::sleep, gravity, law, collide::mesh_forces, collide::reaction, collide::moving_bodies<>>
      some(space, w, {0.01, 50}, gravity{}, law_of<law>(2e6, 0.3, 0.5, 0.2), {1000}, sums.effect(1000), {});
  placed<S> const corners(space, w.corners);
  some.made.set_mesh(collide::triangle_soup(corners.data(), corners.size() / 9), {{0, w.corners.size() / 9, {}}});
  collide::set_clumps(some.made, {shape}, {clump_at(0, 0, 0.11), clump_at(0.1, 0.1, 0.29)});
  some.made.steps(2000, S(dt));
  for (auto const slow : some.made.template to_host<collide::slow_steps>()) CHECK((slow >= 50 && slow < 128));
  sums.clear(space);
  some.made.steps(100, S(dt));
  double pressed = 0, given = 0, turned = 0;
  auto const forces = some.made.template to_host<collide::mesh_force>();
  for (std::size_t i = 2; i < forces.size(); i += 3) pressed += double(forces[i]);
  for (auto const& one : sums.read(space)) given += one.linear[2], turned += one.angular[0];
  double const close = sizeof(S) == 4 ? 1e-4 : 1e-9;
  CHECK(pressed == doctest::Approx(weight).epsilon(close));
  CHECK(given == doctest::Approx(-weight * 100 * dt).epsilon(close));
  double const y = (some.centre(0).y() + some.centre(9).y()) / 2;  // where the weight is
  CHECK(turned == doctest::Approx(y * given).epsilon(close * 10));
}

/// A bed that sleeps, is hit and comes to rest again has the same bits in any space, and after a checkpoint while it
/// sleeps; all are awake when gravity changes.
template <class S, class Space>
void check_same_sleeping_clumps(Space const& space) {
  collide::sleep const sleep{0.01, 50};
  auto reference = bed_of_clumps<S, collide::host>::make(collide::host(1), sleep);
  using bed = bed_of_clumps<S, Space>;
  auto found = bed::make(space, sleep), loaded = bed::make(space, sleep);
  S const dt = S(bed::dt);
  auto const slow_of = [](auto const& of) { return of.made.template to_host<collide::slow_steps>(); };
  found.made.steps(3600, dt);
  CHECK(bed::asleep(found) == 9);
  std::stringstream file;
  collide::save(found.made, file);
  collide::load(loaded.made, file);
  auto const go_on = [&](auto& of, std::size_t begun) {
    of.made.steps(5000 - begun, dt);
    of.made.template effect<gravity>().x = 2;
    for (auto const slow : slow_of(of)) CHECK(int(slow) == 0);
    of.made.steps(500, dt);
  };
  go_on(reference, 0);
  go_on(found, 3600);
  go_on(loaded, 3600);
  CHECK(state_of_clumps(found.made) == state_of_clumps(reference.made));
  CHECK(state_of_clumps(loaded.made) == state_of_clumps(reference.made));
  CHECK(slow_of(found) == slow_of(reference));
  CHECK(slow_of(loaded) == slow_of(reference));
}

// ---- sources

/// A source makes clumps that wait for it, turned at random; those of one sphere have the bits of spheres. What a sink
/// takes leaves its place to the next.
template <class S>
struct fountain {
  using law = granular_contact<hertz, mindlin>;
  template <class Space>
  using scene = clumps_in<Space, S, gravity, law, collide::emit, collide::absorbing_box, collide::polydisperse>;

  template <class Space>
  static scene<Space> make(Space const& space) {
    world<S> w;
    add_floor(w, 1, 2);
    collide::emit source;
    source.rate = 40, source.radius = 0.3;
    source.source.position[2] = 3, source.source.half_width = 0.5, source.source.velocity[2] = -2;
    return scene<Space>(space, w, gravity{}, law_of<law>(2e5, 0.4, 0.5), source, {{-9, -9, -9}, {9, 9, -1}}, {});
  }
};
template <class S, class Space>
void check_source_of_clumps(Space const& space) {
  auto reference = fountain<S>::make(collide::host(1));
  auto found = fountain<S>::make(space), loaded = fountain<S>::make(space);
  placed_clump c = clump_at(0, 0, 0.4);
  c.scale = 0.5;
  std::vector<placed_clump> const all(21, c);  // one is there
  collide::set_clumps(reference.made, {potato()}, all, 20);
  collide::set_clumps(found.made, {potato()}, all, 20);
  CHECK(found.made.size() == 63);
  S const dt = S(5e-4);
  auto const born = [](auto const& of) {
    auto const there = of.made.template to_host<collide::alive>();
    for (std::size_t i = 0; i < there.size(); ++i) CHECK(int(there[i]) == int(there[i / 3 * 3]));
    return std::count(there.begin(), there.end(), 1);
  };
  CHECK(born(found) == 3);
  found.made.steps(200, dt);
  CHECK(born(found) == 3 * 5);
  auto const q = found.made.template to_host<collide::clump_rotation>();
  for (std::size_t i = 12; i < 48; i += 12) CHECK(q[i] != q[12 + (i == 12 ? 12 : 0)]);
  reference.made.steps(3000, dt);
  std::stringstream file;
  collide::save(found.made, file);
  collide::load(loaded.made, file);
  found.made.steps(2800, dt);
  loaded.made.steps(2800, dt);
  CHECK(found.made.births().due == 60);
  CHECK(born(found) > 3 * 5);
  CHECK(state_of_clumps(found.made) == state_of_clumps(reference.made));
  CHECK(state_of_clumps(loaded.made) == state_of_clumps(reference.made));
  double const apart = (found.template read<position>(0) - found.template read<position>(2)).norm();
  for (std::size_t i = 0; i < 63; i += 3)
    CHECK((found.template read<position>(i) - found.template read<position>(i + 2)).norm() ==
          doctest::Approx(apart).epsilon(1e-5));
}
/// A few clumps, in a scene with all effects that know them, have the bits of the host.
template <class S, class Space>
auto end_of_few_clumps(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  world<S> w;
  add_floor(w, 1, 1);
  collide::emit source;
  source.rate = 100, source.radius = 0.3;
  source.source.position[2] = 1.2, source.source.half_width = 0.5, source.source.velocity[2] = -2;
  collide::flow_sums sums(space, 1e-6);
  auto const through = sums.through({0, 0, 0.7}, {0, 0, -1}, collide::one_density{1000});
  clumps_in<Space, S, gravity, law, collide::contact_work<>, collide::emit, collide::external_forces<>,
            collide::absorbing_box, collide::mass_flow<>, collide::polydisperse, collide::periodic_box>
      some(space, w, gravity{}, law_of<law>(2e5, 0.4, 0.5), {{1000}}, source, {{1000}}, {{-9, -9, -9}, {9, 9, 0.2}},
           through, {}, {{-2, -2, -2}, {2, 2, 2}});
  placed_clump c = clump_at(0, 0, 0.3);
  c.scale = 0.5;
  collide::set_clumps(some.made, {potato()}, std::vector<placed_clump>(11, c), 10);
  std::vector<S> forces(3 * some.made.size(), S(20));
  placed<S> const there(space, forces);
  some.made.template assign<collide::external_force>(there.data());
  for (int k = 0; k < 100; ++k) some.made.step(S(1e-3));
  auto const flow = sums.read(space);
  return std::tuple(state_of_clumps(some.made), some.made.template to_host<collide::alive>(),
                    some.made.template to_host<collide::normal_work>(),
                    some.made.template to_host<collide::clump_push>(), flow.particles, flow.mass);
}
template <class S, class Space>
void check_few_clumps(Space const& space) {
  auto const here = end_of_few_clumps<S>(collide::host(1)), there = end_of_few_clumps<S>(space);
  CHECK(here == there);
  CHECK(std::count(std::get<1>(here).begin(), std::get<1>(here).end(), 1) > 3);
  auto const& work = std::get<2>(here);
  CHECK(std::count_if(work.begin(), work.end(), [](double x) { return x != 0; }) > 3);
}

template <class Space>
void check_source_of_single_spheres(Space const& space) {
  using S = double;
  auto found = fountain<S>::make(space);
  collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, velocity_verlet, gravity, fountain<S>::law,
                      collide::emit, collide::absorbing_box, collide::polydisperse>
      spheres(space, velocity_verlet{}, gravity{}, found.made.template effect<fountain<S>::law>(),
              found.made.template effect<collide::emit>(), found.made.template effect<collide::absorbing_box>(),
              collide::polydisperse{});
  world<S> w;
  add_floor(w, 1, 2);
  w.radius = 0.3;
  w.particle(0, 0, 0.4);
  placed<S> const corners(space, w.corners), centres(space, w.centres);
  spheres.set_mesh(collide::triangle_soup(corners.data(), corners.size() / 9));
  spheres.set(collide::spheres_xyz(centres.data(), 1, w.radius), nullptr, 21);
  collide::set_clumps(found.made, {collide::shape_of_clump({ball{{0, 0, 0}, 0.3}})},
                      std::vector<placed_clump>(21, clump_at(0, 0, 0.4)), 20);
  spheres.steps(2000, 5e-4);
  found.made.steps(2000, 5e-4);
  CHECK(spheres.births().due == 40);
  CHECK(found.made.template to_host<collide::alive>() == spheres.template to_host<collide::alive>());
  CHECK(found.made.template to_host<position>() == spheres.template to_host<position>());
  CHECK(found.made.template to_host<velocity>() == spheres.template to_host<velocity>());
  found.made.template effect<collide::emit>().only_where_free = true;
  CHECK_THROWS_WITH_AS(found.made.step(5e-4), doctest::Contains("only_where_free"), collide::error);
  clumps_in<Space, S, fountain<S>::law> none(space, {}, law_of<fountain<S>::law>(1e5, 0.5, 0.3));
  CHECK_THROWS_WITH_AS(collide::set_clumps(none.made, {dumbbell(1, 0.2)}, {clump_at(0, 0, 0)}, 1),
                       doctest::Contains("emit"), collide::error);
}

/// Momentum and angular momentum of clumps that meet each other close.
template <class Law, class Space>
void check_momentum_of_clumps(Space const& space) {
  clumps_in<Space, double, Law> some(space, {}, law_of<Law>(1e6, 0.6, 0.4));
  std::vector<clump_shape> const shapes{
      dumbbell(0.3, 0.2),
      collide::shape_of_clump({ball{{0, 0, 0}, 0.2}, ball{{0.25, 0.1, 0}, 0.2}, ball{{0, 0.3, 0.1}, 0.2}})};
  std::vector<placed_clump> all;
  for (int i = 0; i < 27; ++i) {
    placed_clump c = clump_at(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    for (int k = 0; k < 3; ++k) {
      c.moving.linear[k] = -c.at.position[k] * (1 + 0.1 * (i % 5));
      c.moving.angular[k] = std::sin(7 * i + k);
    }
    collide::turn_at_random(c.at.rotation, std::uint64_t(i));
    c.shape = std::size_t(i) % 2;
    all.push_back(c);
  }
  collide::set_clumps(some.made, shapes, all);
  auto const sums = [&] {
    vector p(0, 0, 0), l = p;
    std::size_t i = 0;
    for (auto const& c : all) {
      vector const v = some.speed(i) * shapes[c.shape].volume, x = some.centre(i);
      p += v;
      l += collide::detail::cross(x, v) + some.template read<collide::clump_momentum>(i) * shapes[c.shape].volume;
      i += shapes[c.shape].spheres.size();
    }
    return std::pair(p, l);
  };
  auto const before = sums();
  auto const start = some.speed(0);
  some.made.steps(3000, 2e-4);
  auto const after = sums();
  CHECK((some.speed(0) - start).norm() > 0.1);
  CHECK((before.first - after.first).norm() < 1e-12);
  CHECK((before.second - after.second).norm() < 1e-12);
}

// ---- beside other features

/// A clump of spheres that overlap presses on a body with the weight of its union, and goes with a belt.
template <class S, class Space>
void check_weight_of_clumps(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  world<S> w;
  add_floor(w, 4, 2);
  clump_shape const shape =
      collide::shape_of_clump({ball{{0, 0, 0}, 0.2}, ball{{0.25, 0, 0}, 0.2}, ball{{0.1, 0.2, 0}, 0.2}});
  double const weight = 1000 * shape.volume * 9.81, dt = 2e-4;
  collide::reaction_sums sums(space, 1, weight * 1e-12);  // the same rounding in each step
  clumps_in<Space, S, gravity, law, collide::mesh_forces, collide::reaction, collide::moving_bodies<>> one(
      space, {}, gravity{}, law_of<law>(1e6, 0.3, 0.5), {1000}, sums.effect(1000), {});
  placed<S> const corners(space, w.corners);
  collide::body belt{0, w.corners.size() / 9, {}};
  belt.motion.belt[1] = 0.5;
  one.made.set_mesh(collide::triangle_soup(corners.data(), corners.size() / 9), {belt});
  collide::set_clumps(one.made, {shape}, {clump_at(0, -2, 0.2)});
  one.made.steps(20000, S(dt));
  sums.clear(space);
  one.made.steps(500, S(dt));
  double pressed = 0;
  auto const forces = one.made.template to_host<collide::mesh_force>();
  for (std::size_t i = 2; i < forces.size(); i += 3) pressed += double(forces[i]);
  double const close = sizeof(S) == 4 ? 1e-3 : 1e-6;
  CHECK(pressed == doctest::Approx(weight).epsilon(close));
  CHECK(sums.read(space)[0].linear[2] == doctest::Approx(-weight * 500 * dt).epsilon(close));
  CHECK(one.speed(0).y() == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(shape.volume < 3 * collide::detail::sphere_mass(1.0, 0.2) * 0.9);
}

/// Clumps that meet across the sides of a box that repeats do as they do inside; one that is longer than half a side is
/// refused.
template <class Space>
void check_clumps_in_boxes(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  using scene = clumps_in<Space, double, law, collide::periodic_box>;
  clump_shape const shape = dumbbell(0.25, 0.2);
  auto const end_of = [&](double shift) {
    scene two(space, {}, law_of<law>(1e6, 0.6, 0.4), {{0, 0, 0}, {4, 4, 4}});
    std::vector<placed_clump> both{clump_at(shift + 0.2, 2, 2), clump_at(shift - 0.8, 2.1, 2.05)};
    both[0].moving.linear[0] = -1, both[1].moving.angular[2] = 2;
    collide::turn_at_random(both[0].at.rotation, 3);
    collide::set_clumps(two.made, {shape}, both);
    two.made.steps(8000, 2e-4);
    auto ends = state_of_clumps(two.made);
    for (std::size_t i = 0; i < 12; i += 3) {
      double& x = std::get<0>(ends)[i];
      CHECK((x >= 0 && x < 4));
      x = std::fmod(x - shift + 6, 4);
    }
    return ends;
  };
  auto const inside = end_of(2), across = end_of(0);
  for (std::size_t i = 0; i < 12; ++i) {
    CHECK(std::get<0>(inside)[i] == doctest::Approx(std::get<0>(across)[i]).epsilon(1e-8));
    CHECK(std::get<1>(inside)[i] == doctest::Approx(std::get<1>(across)[i]).epsilon(1e-8));
  }
  CHECK(std::abs(std::get<1>(inside)[7]) > 0.1);  // they have met
  world<double> w;
  add_floor(w, 2, 1);  // as large as the box: spheres meet it inside of that
  scene at_side(space, w, law_of<law>(1e6, 0.6, 0.4), {{-2, -2, -1}, {2, 2, 3}});
  std::vector<placed_clump> falling{clump_at(-2.1, 0.3, 0.4)};
  falling[0].moving.linear[2] = -1;
  collide::set_clumps(at_side.made, {shape}, falling);
  at_side.made.steps(4000, 1e-4);
  auto const bounced = at_side.made.template to_host<velocity>();
  CHECK(bounced[2] > 0.1);
  CHECK(bounced[5] == doctest::Approx(bounced[2]).epsilon(1e-6));
  scene small(space, {}, law_of<law>(1e6, 0.6, 0.4), {{0, 0, 0}, {1.2, 4, 4}});
  collide::set_clumps(small.made, {dumbbell(1, 0.1)}, {clump_at(0, 0, 0)});
  CHECK_THROWS_WITH_AS(small.made.step(1e-4), doctest::Contains("periodic_box"), collide::error);
}

/// A heap of clumps and balls on a floor, in any space, with a checkpoint in the middle: the same bits. Beside other
/// effects of which all parameters are as by default.
template <class S, class Space, class... Effect>
struct heap_of_clumps {
  using law = granular_contact<hertz, mindlin>;
  using scene = clumps_in<Space, S, gravity, law, Effect..., collide::polydisperse, collide::moving_bodies<>>;

  static world<S> tray() {
    world<S> w;
    add_floor(w, 2, 4);
    return w;
  }
  template <class Scene>
  static void place(Scene& to) {
    std::vector<clump_shape> const shapes{dumbbell(0.3, 0.2), potato(),
                                          collide::shape_of_clump({ball{{0, 0, 0}, 0.25}})};
    std::vector<placed_clump> all;
    for (int i = 0; i < 24; ++i) {
      placed_clump c = clump_at(0.9 * (i % 3 - 1), 0.9 * (i / 3 % 2), 0.6 + 0.9 * (i / 6));
      c.scale = i % 4 == 1 ? 0.5 : 0.8;
      c.shape = std::size_t(i) % 3;
      collide::turn_at_random(c.at.rotation, std::uint64_t(i));
      all.push_back(c);
    }
    collide::set_clumps(to.made, shapes, all);
  }
  static scene make(Space const& space) {
    return scene(space, tray(), gravity{}, law_of<law>(2e5, 0.4, 0.5), Effect{}..., {}, {});
  }
};
/// Elastic, smooth clumps on a floor keep their energy, in which each point of a clump counts once.
template <class Space>
void check_energy_of_clumps(Space const& space) {
  using law = granular_contact<hertz>;
  world<double> w;
  add_floor(w, 4, 4);
  clumps_in<Space, double, gravity, law, collide::polydisperse> some(space, w, gravity{}, law_of<law>(1e6, 1, 0), {});
  std::vector<placed_clump> all;
  for (int i = 0; i < 8; ++i) {
    all.push_back(clump_at(1.7 * (i % 2), 1.7 * (i / 2 % 2), 1.1 + 1.7 * (i / 4)));
    all.back().shape = std::size_t(i) % 2;
    all.back().moving.angular[i % 3] = 3;
    collide::turn_at_random(all.back().at.rotation, std::uint64_t(i));
  }
  std::vector<clump_shape> const shapes{potato(), dumbbell(0.3, 0.25)};
  collide::set_clumps(some.made, shapes, all);
  auto const before = collide::energy(some.made);
  double mass = 0, turns = 0;
  for (auto const& c : all) {
    auto const& shape = shapes[c.shape];
    mass += 1000 * shape.volume;
    turns += shape.volume * *std::min_element(shape.inertia, shape.inertia + 3) * 4500;
  }
  CHECK(before.rotational > turns);
  CHECK(before.elastic == 0);
  some.made.steps(5000, 1e-4);
  auto const after = collide::energy(some.made);
  CHECK(after.total() == doctest::Approx(before.total()).epsilon(1e-4));
  CHECK(after.kinetic > 0.1 * before.total());
  CHECK(after.rotational != doctest::Approx(before.rotational).epsilon(0.1));
  CHECK(before.potential > 9.81 * mass * 1.0);
  CHECK(before.potential < 9.81 * mass * 3.0);
}

/// Of clumps that slide, roll and are damped, on a belt, all energy is accounted for.
template <class Space>
void check_balance_of_clumps(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  world<double> w;
  add_floor(w, 4, 4);
  clumps_in<Space, double, gravity, law, collide::polydisperse, collide::moving_bodies<>, collide::contact_work<>> some(
      space, w, gravity{}, law_of<law>(1e6, 0.4, 0.5, 0.1), {}, {}, {{1000}});
  placed<double> const corners(space, w.corners);
  collide::body belt{0, w.corners.size() / 9, {}};
  belt.motion.belt[1] = 0.5;
  some.made.set_mesh(collide::triangle_soup(corners.data(), corners.size() / 9), {belt});
  std::vector<placed_clump> all;
  for (int i = 0; i < 12; ++i) {
    all.push_back(clump_at(1.2 * (i % 2), 1.2 * (i / 2 % 2), 0.9 + 1.2 * (i / 4)));
    all.back().shape = std::size_t(i) % 3;
    all.back().scale = 0.8;
    all.back().moving.angular[i % 3] = 3;
    collide::turn_at_random(all.back().at.rotation, std::uint64_t(i));
  }
  collide::set_clumps(some.made, {potato(), dumbbell(0.3, 0.25), collide::shape_of_clump({ball{{0, 0, 0}, 0.4}})}, all);
  auto const before = collide::energy(some.made);
  some.made.steps(12000, 1e-4);
  auto const after = collide::energy(some.made);
  CHECK(after.lost() > 0.5 * before.total());
  CHECK(after.sliding > 0.01 * before.total());
  CHECK(after.damping > 0.1 * before.total());
  CHECK(after.given > 1e-3 * before.total());
  CHECK(std::abs(after.balance() - before.balance()) < 1e-7 * before.total());
}

/// A heap of clumps at rest: its stress times the volume is what its weight asks for, and it does not turn.
template <class Space>
void check_stress_of_clumps(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  world<double> w;
  add_floor(w, 9, 2);
  clumps_in<Space, double, gravity, law, collide::polydisperse, collide::drag> at_rest(
      space, w, gravity{}, law_of<law>(1e6, 0.1, 0.8), {}, {3});
  heap_of_clumps<double, Space>::place(at_rest);
  at_rest.made.steps(40000, 4e-4);
  collide::energy_sums const e = collide::energy(at_rest.made);
  CHECK(e.kinetic < 1e-6 * e.potential);
  double const side = 20, volume = side * side * side;
  auto const found = collide::stress(at_rest.made, {-side / 2, -side / 2, -side / 2}, {side / 2, side / 2, side / 2});
  CHECK(found.contact_stress[2][2] * volume == doctest::Approx(e.potential).epsilon(1e-3));
  CHECK(found.density * volume * 9.81 < e.potential / 0.2);
  for (int k = 0; k < 3; ++k) {
    int const j = (k + 1) % 3;
    CHECK(std::abs(found.contact_stress[k][j] - found.contact_stress[j][k]) < 1e-3 * found.contact_stress[2][2]);
    CHECK(std::abs(found.kinetic_stress[k][k]) < 1e-5 * found.contact_stress[2][2]);
  }
  double mass = 0;
  auto const heavier = at_rest.made.template to_host<collide::clump_mass>();
  auto const first = at_rest.made.template to_host<collide::in_clump>();
  auto const radii = at_rest.made.template to_host<collide::radius>();
  for (std::size_t i = 0; i < radii.size(); ++i)
    if (first[i] == i || first[i] == collide::no_id)
      mass += heavier[i] * collide::detail::sphere_mass(1000.0, radii[i]);
  CHECK(found.density * volume == doctest::Approx(mass).epsilon(1e-12));
}

template <class S, class... Effect, class Space>
void check_same_clumps(Space const& space) {
  using on_host = heap_of_clumps<S, collide::host, Effect...>;
  using there = heap_of_clumps<S, Space, Effect...>;
  auto reference = on_host::make(collide::host(1));
  auto found = there::make(space), loaded = there::make(space);
  on_host::place(reference);
  there::place(found);
  S const dt = S(4e-4);
  reference.made.steps(1500, dt);
  found.made.steps(700, dt);
  std::stringstream file;
  collide::save(found.made, file);
  collide::load(loaded.made, file);
  found.made.steps(800, dt);
  loaded.made.steps(800, dt);
  CHECK(state_of_clumps(found.made) == state_of_clumps(reference.made));
  CHECK(state_of_clumps(loaded.made) == state_of_clumps(reference.made));
  CHECK(reference.made.template effect<clumps>().reach == loaded.made.template effect<clumps>().reach);
}

}  // namespace tests
