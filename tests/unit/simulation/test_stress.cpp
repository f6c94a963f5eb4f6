/// Stress and fields of grains, against closed forms: two spheres, a box under its own weight, a sheared cell.
#include <algorithm>

#include <collide/effects/bounds.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/wear.hpp>
#include <collide/simulation/fill.hpp>
#include <collide/simulation/stress.hpp>

#include "simulation/granular.hpp"

namespace {

using tests::gravity;
using tests::pi;
using tests::running;
using tests::world;
template <class... Effect>
using simulation = collide::simulation<tests::meets_mesh<collide::host, collide::karabassi<>, double>, Effect...>;

void add(world<double>& w, collide::filling const& all) {
  for (std::size_t i = 0; i < all.radii.size(); ++i)
    w.particle(all.centres[3 * i], all.centres[3 * i + 1], all.centres[3 * i + 2]);
}

}  // namespace

TEST_CASE("stress: two spheres that press each other, and what they carry along") {
  using law = collide::granular_contact<collide::linear, collide::cundall_strack>;
  double const k = 1000, r = 0.1, mass = 1000 * 4 * pi / 3 * r * r * r;
  world<double> w;
  w.radius = r;
  w.particle(0.4, 0.5, 0.5, 1, 2, 0);
  w.particle(0.59, 0.5, 0.5, 3, 2, 0);  // the two part: the dashpot is 0, and the slip too
  running<simulation<law, collide::velocity_verlet>> made(
      collide::host(1), w, law{collide::one_material({1e7, 0.3, 1000}), {k}}, collide::velocity_verlet{});
  made.simulation.step(1e-12);
  auto const f = collide::stress(made.simulation, {0, 0, 0}, {1, 1, 1});
  CHECK(f.contact_stress[0][0] == doctest::Approx(k * 0.01 * 0.19));
  CHECK(std::abs(f.contact_stress[1][1]) < 1e-12);
  CHECK(f.kinetic_stress[0][0] == doctest::Approx(2 * mass));  // 1 about the mean of 2
  CHECK(std::abs(f.kinetic_stress[1][1]) < 1e-12);
  CHECK(f.velocity[0] == doctest::Approx(2));
  CHECK(f.density == doctest::Approx(2 * mass));
  CHECK(f.coordination == doctest::Approx(1));
  CHECK(collide::normal_forces(made.simulation)[0] == doctest::Approx(k * 0.01));
  // of half of the line, in which there is one sphere
  auto const half = collide::stress(made.simulation, {0, 0, 0}, {0.495, 1, 1});
  CHECK(half.contact_stress[0][0] == doctest::Approx(k * 0.01 * 0.095 / 0.495));
  CHECK(half.solid_fraction == doctest::Approx(4 * pi / 3 * r * r * r / 0.495));
  // the integral over a grid is the same
  collide::stress_grid const grid{{0, 0, 0}, {1, 1, 1}, {20, 20, 20}, 0.3};
  double stress = 0, density = 0, flux = 0;
  for (auto const& at : collide::stress(made.simulation, grid)) {
    stress += at.contact_stress[0][0] / 8000;
    density += at.density / 8000;
    flux += at.density * at.velocity[1] / 8000;
  }
  CHECK(stress == doctest::Approx(k * 0.01 * 0.19).epsilon(2e-3));
  CHECK(density == doctest::Approx(2 * mass).epsilon(2e-3));
  CHECK(flux == doctest::Approx(4 * mass).epsilon(2e-3));
  CHECK_THROWS_AS(collide::stress(made.simulation, {0, 0, 0}, {1, 0, 1}), collide::error);
}

TEST_CASE("normal_forces: in a stack each sphere carries those above") {
  using law = collide::granular_contact<collide::hertz>;
  double const r = 0.01, weight = 2500 * 4 * pi / 3 * r * r * r * 9.81;
  world<double> w;
  w.radius = r;
  tests::add_floor(w, 1, 3);
  for (int k = 0; k < 4; ++k) w.particle(0, 0, r * (2 * k + 1));
  running<simulation<gravity, law, collide::velocity_verlet>> made(
      collide::host(1), w, gravity{}, law{collide::one_material({1e6, 0.2, 2500}, {0.2})}, collide::velocity_verlet{});
  made.simulation.steps(20000, 5e-5);
  std::vector<double> forces = collide::normal_forces(made.simulation);
  std::sort(forces.begin(), forces.end());
  REQUIRE(forces.size() == 3);
  for (int k = 0; k < 3; ++k) CHECK(forces[k] == doctest::Approx((k + 1) * weight).epsilon(1e-6).scale(0));
}

TEST_CASE("stress: a box under its own weight carries what is above, on smooth walls") {
  using law =
      collide::granular_contact<collide::hertz, collide::mindlin, collide::none, collide::none, collide::materials<2>>;
  using scene = simulation<gravity, law, collide::velocity_verlet>;
  double const side = 0.1, high = 0.25, r = 0.008, density = 2500;
  collide::materials<2> m;
  m.set(0, {5e5, 0.3, density});
  m.set(1, {5e5, 0.3, density});
  m.set_pair(0, 0, {0.3, 0.5});
  m.set_pair(0, 1, {0.3, 0});
  m.set_pair(1, 1, {});
  m.wall_material = 1;
  world<double> w;
  w.radius = r;
  tests::add_quad(w, {0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0});
  double const c[] = {0, 0, side, 0, side, side, 0, side, 0, 0};
  for (int k = 0; k < 4; ++k)
    tests::add_quad(w, {c[2 * k], c[2 * k + 1], 0}, {c[2 * k + 2], c[2 * k + 3], 0}, {c[2 * k + 2], c[2 * k + 3], high},
                    {c[2 * k], c[2 * k + 1], high});
  auto const all =
      collide::fill(collide::box_region{{0, 0, 0}, {side, side, 0.2}}, collide::size_distribution::one(r), 0.45, 1);
  add(w, all);
  running<scene> made(collide::host(1), w, gravity{}, law{m}, collide::velocity_verlet{});
  double const dt = collide::largest_time_step(made.simulation) / 4;  // they shake with longer steps
  made.simulation.steps(static_cast<std::size_t>(2 / dt), dt);
  double const weight = density * 4 * pi / 3 * r * r * r * 9.81;
  auto const x = made.positions();
  for (double const low : {0.02, 0.06, 0.1}) {
    auto const f = collide::stress(made.simulation, {0, 0, low}, {side, side, low + 0.04});
    double above = 0;
    for (std::size_t i = 0; i < w.size(); ++i)
      above += weight * std::min(std::max((x[3 * i + 2] - low) / 0.04, 0.0), 1.0);
    CHECK(f.contact_stress[2][2] == doctest::Approx(above / side / side).epsilon(0.01).scale(0));
    CHECK(std::abs(f.contact_stress[0][2]) < 0.1 * f.contact_stress[2][2]);
    CHECK(f.solid_fraction > 0.5);
    CHECK(f.coordination > 4);
    CHECK(f.contact_stress[0][0] > 0.2 * f.contact_stress[2][2]);
  }
}

TEST_CASE("stress: in a sheared cell it is the force of the plate over its area") {
  using law = collide::granular_contact<collide::hertz, collide::mindlin>;
  using scene =
      simulation<law, collide::reaction, collide::periodic_box, collide::moving_bodies<>, collide::velocity_verlet>;
  double const side = 0.1, high = 0.08, r = 0.008;
  world<double> w;
  w.radius = 1.075 * r;  // denser than `fill` gets a small box
  tests::add_quad(w, {-1, -1, high}, {1, -1, high}, {1, 1, high}, {-1, 1, high});
  tests::add_quad(w, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  add(w,
      collide::fill(collide::box_region{{0, 0, 0}, {side, side, high}}, collide::size_distribution::one(r), 0.44, 1));
  collide::host const space(1);
  collide::reaction_sums sums(space, 1, 1e-12);
  collide::body plate{0, 2, {}};
  plate.motion.belt[0] = 0.5;
  tests::running_bodies<scene> made(space, w, std::vector<collide::body>{plate},
                                    law{collide::one_material({1e5, 0.3, 2500}, {0.3, 0.5})}, sums.effect(2500),
                                    collide::periodic_box{{0, 0, -1}, {side, side, 2}}, collide::moving_bodies<>{},
                                    collide::velocity_verlet{});
  double const dt = collide::largest_time_step(made.simulation);
  made.simulation.steps(static_cast<std::size_t>(1 / dt), dt);
  sums.clear(space);
  double shear = 0, pressure = 0, time = 0;
  int const looks = 400;
  for (int k = 0; k < looks; ++k) {
    made.simulation.steps(10, dt);
    time += 10 * dt;
    auto const f = collide::stress(made.simulation, {0, 0, 0.02}, {side, side, high - 0.02});
    shear += (f.contact_stress[0][2] + f.kinetic_stress[0][2]) / looks;
    pressure += (f.contact_stress[2][2] + f.kinetic_stress[2][2]) / looks;
  }
  auto const given = sums.read(space)[0];
  CHECK(given.linear[2] > 0);
  CHECK(given.linear[0] < 0);
  CHECK(pressure == doctest::Approx(given.linear[2] / time / side / side).epsilon(0.06).scale(0));
  CHECK(shear == doctest::Approx(given.linear[0] / time / side / side).epsilon(0.1).scale(0));
}

TEST_CASE("wear: a sphere that slides until it rolls gives the mesh its weight, and a seventh of m v^2") {
  using law = collide::granular_contact<collide::hertz, collide::mindlin>;
  using scene = simulation<gravity, law, collide::wear<>, collide::moving_bodies<>, collide::velocity_verlet>;
  double const r = 0.01, speed = 0.5, mass = 2500 * 4 * pi / 3 * r * r * r;
  law const by{collide::one_material({1e7, 0.2, 2500}, {0.3, 0.5}), {}, tests::mindlin_of_lammps(true)};
  double const deep = std::pow(mass * 9.81 / (4.0 / 3 * (1e7 / (2 * (1 - 0.04))) * std::sqrt(r)), 2.0 / 3);
  for (bool const is_belt : {false, true}) {
    world<double> w;
    w.radius = r;
    tests::add_divided_floor(w, 1, 8);
    w.particle(0.01, 0.02, r - deep, is_belt ? 0 : speed);
    collide::body_motion belt;
    if (is_belt) belt.belt[0] = -speed;
    collide::host const space(1);
    std::size_t const triangles = w.corners.size() / 9;
    collide::wear_sums sums(space, triangles, mass * 1e-9, mass * 1e-9);
    tests::running_bodies<scene> made(space, w, tests::one_body(w, belt), gravity{}, by,
                                      sums.effect(collide::one_density{2500}), collide::moving_bodies<>{},
                                      collide::velocity_verlet{});
    double const dt = 1e-5;
    made.simulation.steps(20000, dt);
    double impulse = 0, work = 0;
    std::size_t worn = 0;
    for (auto const& load : sums.read(space)) {
      impulse += load.normal_impulse, work += load.sliding_work;
      worn += load.normal_impulse > 0 ? 1 : 0;
    }
    CHECK(impulse == doctest::Approx(mass * 9.81 * 20000 * dt).epsilon(1e-3).scale(0));
    CHECK(work ==
          doctest::Approx(mass * speed * speed / 7).epsilon(4e-3).scale(0));  // the arm is half the overlap shorter
    CHECK(worn <= 6);
    CHECK(worn >= 1);
    sums.clear(space);
    CHECK(sums.read(space)[0].normal_impulse == 0);
  }
}

TEST_CASE("reaction: spheres of several materials press with their weights") {
  using law =
      collide::granular_contact<collide::hertz, collide::none, collide::none, collide::none, collide::materials<2>>;
  using scene = simulation<gravity, law, collide::reaction_of<collide::materials<2>>, collide::velocity_verlet>;
  collide::materials<2> m;
  m.set(0, {1e6, 0.3, 1000});
  m.set(1, {1e6, 0.3, 7000});
  m.set_pair(0, 0, {0.2});
  m.set_pair(0, 1, {0.2});
  m.set_pair(1, 1, {0.2});
  world<double> w;
  double const r = w.radius = 0.01;
  tests::add_divided_floor(w, 1, 4);
  w.particle(0.1, 0.2, r);
  w.particle(0.3, 0.2, r);
  collide::host const space(1);
  collide::reaction_sums sums(space, 0, 1e-12);
  running<scene> made(space, w, gravity{}, law{m}, sums.effect(m), collide::velocity_verlet{});
  made.simulation.assign<collide::material>(std::vector<std::uint8_t>{0, 1});
  made.simulation.steps(10000, 1e-4);
  sums.clear(space);
  made.simulation.steps(1000, 1e-4);
  CHECK(sums.read(space)[0].linear[2] ==
        doctest::Approx(-8000 * 4 * pi / 3 * r * r * r * 9.81 * 0.1).epsilon(1e-4).scale(0));
}
