/// Forces that another program writes, in a space; instantiated by test_coupling.cpp and test_effects_cuda.cpp.
#pragma once

#include <collide/effects/bounds.hpp>
#include <collide/effects/contact_forces.hpp>
#include <collide/effects/external_forces.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/sleep.hpp>

#include "simulation/simulation.hpp"

namespace tests {

/// Spheres of many sizes fly as a force that changes from step to step makes them, each by its own mass.
template <class Integrator, class S, class Space>
void check_external_forces(Space const& space) {
  using forces = collide::external_forces<>;
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::polydisperse, forces, Integrator>;
  constexpr bool is_verlet = std::is_same<Integrator, collide::velocity_verlet>::value;
  constexpr double density = 2500, dt = 1e-3;
  world<S> w;
  w.triangle({90, 90, 90, 91, 90, 90, 90, 91, 90});
  for (int i = 0; i < 70; ++i) {
    w.particle(i % 8, i / 8, 0, 0.1 * i, 0, 1);
    w.radii.push_back(S(0.01 * (1 + i % 7)));
  }
  running<simulation> made(space, w, collide::polydisperse{}, forces{{density}}, Integrator{});
  std::vector<double> x(w.centres.begin(), w.centres.end()), v(w.velocities.begin(), w.velocities.end());
  for (int step = 0; step < 20; ++step) {
    std::vector<S> values(x.size());
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = S(0.01 * double(k % 11) - 0.03 * step);
    placed<S> const there(made.simulation.space(), values);
    made.simulation.template assign<collide::external_force>(there.data());
    made.simulation.step(S(dt));
    for (std::size_t k = 0; k < x.size(); ++k) {
      double const r = w.radii[k / 3], kick = double(values[k]) * dt / (density * 4.18879020478639 * r * r * r);
      x[k] += dt * (v[k] + (is_verlet ? kick / 2 : kick));
      v[k] += kick;
    }
  }
  auto const found_x = made.positions(), found_v = made.velocities();
  double const close = sizeof(S) == 4 ? 1e-5 : 1e-13;
  for (std::size_t k = 0; k < x.size(); ++k) {
    CHECK(double(found_x[k]) == doctest::Approx(x[k]).epsilon(close));
    CHECK(double(found_v[k]) == doctest::Approx(v[k]).epsilon(close));
  }
}

/// A solver that resists after Stokes, written step by step: spheres fall at the terminal velocity, which differs with
/// the material.
template <class Space>
void check_external_forces_of_materials(Space const& space) {
  using of_materials = collide::external_forces<collide::materials<2>>;
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, collide::gravity, of_materials>;
  collide::materials<2> solids;
  double const densities[2] = {2500, 7200}, resistance = 0.05, g = 10;
  for (int i = 0; i < 2; ++i) solids.set(i, {1e6, 0.2, densities[i]});
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k <= i; ++k) solids.set_pair(k, i, {});
  world<double> w;
  w.radius = 0.01;
  w.triangle({90, 90, 90, 91, 90, 90, 90, 91, 90});
  for (int i = 0; i < 3; ++i) w.particle(i, 0, 0);
  running<simulation> made(space, w, collide::gravity{0, 0, -g}, of_materials{solids});
  placed<std::uint8_t> const numbers(made.simulation.space(), {0, 1, 0});
  made.simulation.template assign<collide::material>(numbers.data());
  for (int step = 0; step < 3000; ++step) {
    auto values = made.velocities();
    for (double& f : values) f *= -resistance;
    placed<double> const there(made.simulation.space(), values);
    made.simulation.template assign<collide::external_force>(there.data());
    made.simulation.step(1e-2);
  }
  auto const v = made.velocities();
  for (std::size_t i = 0; i < 3; ++i) {
    double const mass = densities[i % 2] * 4.18879020478639e-6;
    CHECK(v[3 * i] == 0);
    CHECK(v[3 * i + 2] == doctest::Approx(-mass * g / resistance).epsilon(1e-12));
  }
}

/// A particle on a floor presses with the force on it; asleep it does so too, and rises once it is woken.
template <class Space>
void check_external_forces_at_rest(Space const& space) {
  using forces = collide::external_forces<>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, forces, collide::bounce,
                                         collide::sleep, collide::mesh_forces>;
  world<double> w;
  add_floor(w, 9, 3);
  w.radius = 0.5;
  w.particle(0, 0, 0.5);
  running<simulation> made(space, w, forces{{3}}, collide::bounce{0.5}, collide::sleep{0.01, 50},
                           collide::mesh_forces{3});
  auto const force_of_floor = [&] { return made.simulation.template to_host<collide::mesh_force>()[2]; };
  auto const push = [&](double force) {
    placed<double> const there(made.simulation.space(), {0, 0, force});
    made.simulation.template assign<collide::external_force>(there.data());
  };
  push(-7);
  made.simulation.steps(20, 1e-3);
  CHECK(force_of_floor() == doctest::Approx(7).epsilon(1e-9));
  made.simulation.steps(100, 1e-3);
  CHECK(force_of_floor() == doctest::Approx(7).epsilon(1e-9));
  double const up = 7;  // in place, which wakes nothing
  made.simulation.space().copy_from_host(made.simulation.template data<collide::external_force>() + 2, &up, 1);
  made.simulation.steps(20, 1e-3);
  CHECK(made.positions()[2] == doctest::Approx(0.5).epsilon(1e-9));
  push(7);
  made.simulation.steps(100, 1e-3);
  CHECK(made.positions()[2] > 0.51);
  CHECK(force_of_floor() == 0);
}

/// Walls of a box hold each sphere at its own radius, also where no effect looks at the mesh.
template <class Space>
void check_walls_of_sizes(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space>, collide::polydisperse, collide::gravity, collide::box_walls>;
  world<float> w;
  w.triangle({90, 90, 90, 91, 90, 90, 90, 91, 90});
  collide::box_walls walls;
  walls.lower[2] = 0;
  for (int i = 0; i < 20; ++i) {
    w.particle(i, 0, 2);
    w.radii.push_back(0.1f * float(1 + i % 5));
  }
  running<simulation> made(space, w, collide::polydisperse{}, collide::gravity{}, walls);
  made.simulation.steps(5000, 1e-3f);
  auto const x = made.positions();
  for (std::size_t i = 0; i < 20; ++i) CHECK(x[3 * i + 2] == doctest::Approx(w.radii[i]).epsilon(1e-3));
}

}  // namespace tests
