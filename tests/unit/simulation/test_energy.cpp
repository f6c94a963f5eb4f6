/// The energy of particles, against numbers found by hand.
#include <collide/effects/absorb.hpp>
#include <collide/effects/spin.hpp>
#include <collide/energy.hpp>

#include "simulation/simulation.hpp"

namespace {

using collide::energy;
using collide::host;

/// Two spheres of mass 2 that overlap by 0.25, and one that is gone.
template <class S>
void check_energy() {
  using simulation = collide::simulation<tests::meets_mesh<host, collide::karabassi<>, S>, collide::gravity,
                                         collide::sphere_contact, collide::spin, collide::absorb>;
  collide::sphere_contact springs;
  springs.stiffness = 8;
  springs.density = 2 / (4 * 3.141592653589793 / 3 * 0.125);
  tests::world<S> w;
  w.radius = S(0.5);
  w.particle(0, 0, 1, 3, 4, 0);
  w.particle(0.75, 0, 1);
  w.particle(0, 0.5, 1, 100, 0, 0);
  tests::running<simulation> made(host(1), w, collide::gravity{1, 0, -10}, springs, collide::spin{}, collide::absorb{});
  std::vector<S> const turning{0, 0, 2, 0, 0, 0, 50, 0, 0};
  std::vector<std::uint8_t> const there{1, 1, 0};
  made.simulation.template assign<collide::angular_velocity>(turning);
  made.simulation.template assign<collide::alive>(there);
  auto const found = energy(made.simulation);
  CHECK(found.kinetic == doctest::Approx(0.5 * 2 * 25));
  CHECK(found.rotational == doctest::Approx(0.5 * 0.4 * 2 * 0.25 * 4));
  CHECK(found.elastic == doctest::Approx(0.5 * 8 * 0.0625));
  CHECK(found.potential == doctest::Approx(2 * 10 * 2 - 2 * 0.75));
  CHECK(found.total() == doctest::Approx(25 + 0.4 + 0.25 + 38.5));
  CHECK(energy(made.simulation, 2 * springs.density).kinetic == doctest::Approx(50));
}

}  // namespace

TEST_CASE("energy: of motion, of springs and in gravity") {
  check_energy<float>();
  check_energy<double>();
}

TEST_CASE("energy: each sphere of its own radius, and a density that makes sense") {
  using simulation = collide::simulation<tests::meets_mesh<host>, collide::polydisperse>;
  tests::world<float> w;
  w.particle(0, 0, 0, 1);
  w.particle(0, 0, 5, 1);
  w.radii = {1, 2};
  tests::running<simulation> made(host(1), w, collide::polydisperse{});
  CHECK(energy(made.simulation, 3).total() == doctest::Approx(0.5 * 4 * 3.141592653589793 * 9));
  for (double const density : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_THROWS_WITH_AS(energy(made.simulation, density),
                         "collide: energy: density is above 0: give it, or name sphere_contact", collide::error);
  }
}
