/// Forces of contacts as columns, in a space; instantiated by test_simulation.cpp and test_simulation_cuda.cpp.
#pragma once

#include <collide/effects/contact_forces.hpp>
#include <collide/effects/friction.hpp>

#include "simulation/simulation.hpp"

namespace tests {

/// A particle that lies on a plane is pressed by its weight, on an incline along it too; one that falls by nothing, and
/// what hits is stopped.
template <class NarrowPhase, class Space>
void check_mesh_forces(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase>, collide::gravity, collide::bounce,
                                         collide::friction, collide::mesh_forces>;
  constexpr double density = 3, r = 0.5, mass = density * 4.18879020478639 * r * r * r, dt = 1e-3, g = 9.81;
  world<float> w;
  w.triangle({-9, -9, 0, 9, -9, 0, 0, 9, 0});
  w.radius = float(r);
  w.particle(0, 0, r);
  w.particle(3, 0, 5);
  w.particle(-3, 0, r - 1e-3, 0, 0, -2);
  running<simulation> made(space, w, collide::gravity{2, 0, -g}, collide::bounce{0.5}, collide::friction{0.5, 0.5},
                           collide::mesh_forces{density});
  auto const forces = [&] { return made.simulation.template to_host<collide::mesh_force>(); };
  made.simulation.step(float(dt));
  auto f = forces();
  REQUIRE(f.size() == 9);
  for (std::size_t k = 3; k < 6; ++k) CHECK(f[k] == 0);
  CHECK(f[8] * dt == doctest::Approx(mass * 2 * 1.5).epsilon(g * dt));
  for (int i = 0; i < 10; ++i) made.simulation.step(float(dt));
  f = forces();
  CHECK(f[0] == doctest::Approx(-mass * 2).epsilon(1e-3));
  CHECK(f[1] == 0);
  CHECK(f[2] == doctest::Approx(mass * g).epsilon(1e-3));
  for (std::size_t k = 6; k < 9; ++k) CHECK(f[k] == 0);  // it is in the air again
}

/// Spheres that overlap push each other with opposite forces, those of all neighbours are summed, and they are 0 once
/// the spheres are apart.
template <class S, class Space>
void check_pair_forces(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::sphere_contact, collide::pair_forces>;
  collide::sphere_contact contact;
  contact.stiffness = 100;
  contact.density = 2;
  world<S> w;
  w.radius = S(0.5);
  for (double x : {0., 0.9, 1.7, 5.}) w.particle(x, 0, 0);
  running<simulation> made(space, w, contact, collide::pair_forces{2});
  auto const forces = [&] { return made.simulation.template to_host<collide::pair_force>(); };
  made.simulation.step(S(1e-4));
  auto const f = forces();
  double const first = 100 * 0.1, second = 100 * 0.2, expected[] = {-first, first - second, second, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(double(f[3 * i]) == doctest::Approx(expected[i]).epsilon(1e-3));
    CHECK(f[3 * i + 1] == 0);
  }
  made.simulation.steps(4000, S(1e-3));
  for (S const x : forces()) CHECK(x == 0);
}

}  // namespace tests
