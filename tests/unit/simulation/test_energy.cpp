/// The energy of particles, against numbers found by hand.
#include <collide/effects/absorb.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/spin.hpp>
#include <collide/simulation/energy.hpp>

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

namespace {

collide::mindlin without_dashpot() {
  collide::mindlin law;
  law.damping = collide::tangential_damping::none;
  return law;
}

}  // namespace

TEST_CASE("energy: a tangential spring, by its formula") {
  using law_type = collide::granular_contact<collide::hertz, collide::mindlin>;
  using simulation = collide::simulation<tests::meets_mesh<host, collide::karabassi<>, double>, law_type>;
  collide::solid const stuff{1e6, 0.25, 1000};
  law_type const law{collide::one_material(stuff, {1, 1e3}), {}, without_dashpot()};
  tests::world<double> w;
  w.radius = 0.01;
  double const overlap = 1e-4, speed = 0.02, dt = 1e-5;
  w.particle(0, 0, 0);
  w.particle(0, 0, 0.02 - overlap, speed, 0, 0);
  tests::running<simulation> made(host(1), w, law);
  CHECK(energy(made.simulation).tangential == 0);
  made.simulation.step(dt);
  // 8 G* a with 1/G* = 2 (2 - nu) / G, the area of contact a^2 = R* overlap
  double const shear = 1e6 / 2.5 / (2 * 1.75), distance = std::hypot(0.02 - overlap, speed * dt),
               a = std::sqrt(0.005 * (0.02 - distance)), spring = speed * dt;
  CHECK(energy(made.simulation).tangential == doctest::Approx(0.5 * 8 * shear * a * spring * spring).epsilon(1e-4));
}

TEST_CASE("energy: a grain that is gone holds no spring") {
  using law_type = collide::granular_contact<collide::hertz, collide::mindlin>;
  using simulation =
      collide::simulation<tests::meets_mesh<host, collide::karabassi<>, double>, law_type, collide::absorbing_box>;
  tests::world<double> w;
  w.radius = 0.01;
  w.particle(0, 0, 0);
  w.particle(0, 0, 0.0199, 0.02, 0, 0);
  tests::running<simulation> made(host(1), w, law_type{collide::one_material({1e6, 0.25, 1000}, {1, 1e3})},
                                  collide::absorbing_box{{-1, -1, 0.01}, {1, 1, 1}});
  made.simulation.step(1e-5);
  CHECK(made.simulation.to_host<collide::alive>() == std::vector<std::uint8_t>{1, 0});
  CHECK(energy(made.simulation).tangential == 0);
}

TEST_CASE("energy: springs, motion and spin of a chain that goes round a box add up to the same") {
  using law_type = collide::granular_contact<collide::hertz, collide::mindlin>;
  using simulation = collide::simulation<tests::meets_mesh<host, collide::karabassi<>, double>, law_type,
                                         collide::velocity_verlet, collide::periodic_box>;
  law_type const law{collide::one_material({1e6, 0.25, 1000}, {1, 1e3}), {}, without_dashpot()};
  tests::world<double> w;
  w.radius = 0.01;
  double const step = 0.0198;
  for (int i = 0; i < 3; ++i) w.particle(step * i, 0.05, 0.05, 0, i == 0 ? 0.002 : i == 1 ? -0.002 : 0, 0);
  tests::running<simulation> made(host(1), w, law, collide::velocity_verlet{},
                                  collide::periodic_box{{0, 0, 0}, {3 * step, 0.1, 0.1}});
  double const begin = energy(made.simulation).total(), moving = energy(made.simulation).kinetic;
  double most = 0, off = 0;
  for (int k = 0; k < 200; ++k) {
    made.simulation.steps(10, 2e-6);
    auto const now = energy(made.simulation);
    most = std::max(most, now.tangential);
    off = std::max(off, std::abs(now.total() - begin));
  }
  CHECK(most > 0.3 * moving);
  CHECK(off < 0.02 * moving);
}
