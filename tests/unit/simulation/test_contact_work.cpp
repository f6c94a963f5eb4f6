/// The work that contacts take and walls give, against closed forms; and the balance of energy, which closes.
#include <collide/effects/bounds.hpp>
#include <collide/effects/contact_forces.hpp>
#include <collide/effects/contact_work.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/simulation/fill.hpp>
#include <collide/simulation/stress.hpp>

#include "simulation/granular.hpp"

namespace {

using tests::gravity;
using tests::hertz;
using tests::mindlin;
using tests::none;
using tests::pi;
using tests::running;
using tests::velocity_verlet;
using tests::world;
template <class... Effect>
using simulation = collide::simulation<tests::meets_mesh<collide::host, collide::karabassi<>, double>, Effect...>;
using work = collide::contact_work<>;

constexpr double density = 2500, radius = 0.01, mass = density * 4 * pi / 3 * radius * radius * radius;

work of_grains(double arm_shortening = 0.5) { return {{density}, arm_shortening}; }
collide::one_material solid_of(collide::surface_pair const& surfaces, double young = 1e7) {
  return collide::one_material({young, 0.2, density}, surfaces);
}
/// How deep a grain lies in a floor.
double depth(double young = 1e7) {
  return std::pow(mass * 9.81 / (4.0 / 3 * (young / (2 * (1 - 0.04))) * std::sqrt(radius)), 2.0 / 3);
}

/// The balance of two spheres on a floor, without gravity.
template <class... Effect>
void check_semi_implicit(Effect const&... effects) {
  using law = collide::granular_contact<collide::linear, collide::cundall_strack>;
  world<double> w;
  w.radius = radius;
  tests::add_floor(w, 1, 3);
  w.particle(0, 0, 1.01 * radius, 0.5, 0, -1);
  w.particle(0.1 * radius, 0, 3.1 * radius, 0, 0, -1);
  running<simulation<law, work, Effect...>> made(collide::host(1), w, law{solid_of({0.5, 0.5}), {1000}}, of_grains(),
                                                 effects...);
  double const before = collide::energy(made.simulation).total();
  made.simulation.steps(4000, 1e-5);
  auto const found = collide::energy(made.simulation);
  CHECK(found.damping > 0.1 * before);
  CHECK(found.sliding > 0.01 * before);
  CHECK(std::abs(found.balance() / before - 1) < 1e-12);
}

}  // namespace

TEST_CASE("contact_work: a sphere that rebounds has lost 1 - e^2 of its energy to damping") {
  using law = collide::granular_contact<hertz>;
  double const e = 0.6, energy = mass / 2;
  for (bool const at_wall : {false, true}) {
    world<double> w;
    w.radius = radius;
    if (at_wall) tests::add_floor(w, 1, 3);
    w.particle(0, 0, 1.001 * radius, 0, 0, at_wall ? -1 : -std::sqrt(2.0));
    if (!at_wall) w.particle(0, 0, -1.001 * radius);
    running<simulation<law, work, velocity_verlet>> made(collide::host(1), w, law{solid_of({e})}, of_grains(),
                                                         velocity_verlet{});
    made.simulation.steps(4000, 1e-6);
    auto const found = collide::energy(made.simulation);
    CHECK(found.damping == doctest::Approx((1 - e * e) * energy).epsilon(1e-4).scale(0));  // two have half the mass
    CHECK(std::abs(found.balance() / (at_wall ? energy : 2 * energy) - 1) < 1e-12);
    CHECK(std::abs(found.sliding) < 1e-15 * energy);
    CHECK(found.rolling == 0);
    CHECK(found.given == 0);
  }
}

TEST_CASE("contact_work: with semi-implicit Euler the balance closes where there is no gravity") {
  check_semi_implicit();
  // what contacts do is kept as accelerations
  check_semi_implicit(collide::sleep{1e-6, 100}, collide::mesh_forces{});
}

TEST_CASE("contact_work: of a spring that loses nothing the step keeps the energy to the second order in dt") {
  using law = collide::granular_contact<hertz>;
  double before = 0;
  for (double const dt : {8e-5, 4e-5, 2e-5, 1e-5, 5e-6}) {  // down to 1700 steps an oscillation
    world<double> w;
    w.radius = radius;
    tests::add_floor(w, 1, 3);
    w.particle(0, 0, radius - 1.5 * depth());
    running<simulation<gravity, law, work, velocity_verlet>> made(collide::host(1), w, gravity{}, law{solid_of({1})},
                                                                  of_grains(), velocity_verlet{});
    double const first = collide::energy(made.simulation).elastic;
    made.simulation.step(dt);  // the first half kick is not counted
    auto const begin = collide::energy(made.simulation);
    double most = 0;
    for (int k = 0; k < 100; ++k) {
      made.simulation.steps(static_cast<std::size_t>(std::lround(8e-5 / dt)), dt);
      auto const found = collide::energy(made.simulation);
      CHECK(std::abs(found.balance() - begin.balance()) < 1e-13 * begin.potential);
      most = std::max(most, std::abs(found.damping - begin.damping) / first);
    }
    if (before != 0) CHECK(most < before / 3.8);
    before = most;
  }
  CHECK(before < 1e-6);
}

TEST_CASE("contact_work: a sphere that slides until it rolls loses mu m g times the way it slides") {
  using law = collide::granular_contact<hertz, mindlin>;
  using scene = simulation<gravity, law, work, velocity_verlet>;
  double const mu = 0.5, speed = 0.5, dt = 1e-5;
  mindlin slides;
  slides.damping = collide::tangential_damping::none;  // it would be above the limit at first
  law const by{solid_of({0.3, mu}), {}, slides};
  world<double> w;
  w.radius = radius;
  tests::add_divided_floor(w, 1, 8);
  w.particle(0.01, 0.02, radius - depth(), speed);
  running<scene> made(collide::host(1), w, gravity{}, by, of_grains(), velocity_verlet{});
  made.simulation.step(dt);  // the first half kick is not counted
  auto const at_first = collide::energy(made.simulation);
  double const until = 2 * speed / (7 * mu * 9.81);  // it rolls
  made.simulation.steps(static_cast<std::size_t>(until / 2 / dt), dt);
  auto const now = collide::energy(made.simulation);
  double const t = static_cast<double>(static_cast<std::size_t>(until / 2 / dt)) * dt;
  double const way = speed * t - 3.5 * mu * 9.81 * t * t / 2;
  CHECK(now.sliding == doctest::Approx(mu * mass * 9.81 * way).epsilon(4e-3).scale(0));
  made.simulation.steps(20000, dt);
  auto const last = collide::energy(made.simulation);
  CHECK(last.sliding == doctest::Approx(mass * speed * speed / 7).epsilon(4e-3).scale(0));
  CHECK(std::abs(last.balance() - at_first.balance()) < 1e-8 * mass * speed * speed);
  CHECK(std::abs(last.rolling) < 1e-6 * last.sliding);
  CHECK(last.given == 0);
}

TEST_CASE("contact_work: what rolls loses mu_r m g times the way it rolls, over its arm") {
  using law = collide::granular_contact<hertz, mindlin, collide::constant_torque>;
  using scene = simulation<gravity, law, work, velocity_verlet>;
  double const mu_r = 0.01, speed = 0.1, dt = 1e-5;
  law by{solid_of({0.3, 0.5, mu_r}), {}, tests::mindlin_of_lammps(true)};
  by.arm_shortening = by.slip_shortening = 0;
  world<double> w;
  w.radius = radius;
  tests::add_divided_floor(w, 1, 8);
  w.particle(0.01, 0.02, radius - depth(), speed);
  running<scene> made(collide::host(1), w, gravity{}, by, of_grains(0), velocity_verlet{});
  made.simulation.assign<collide::angular_velocity>(std::vector<double>{0, speed / radius, 0});
  made.simulation.step(dt);
  auto const at_first = collide::energy(made.simulation);
  made.simulation.steps(50000, dt);
  auto const last = collide::energy(made.simulation);
  double const way = made.positions()[0] - 0.01;
  CHECK(way > 0.01);
  CHECK(last.rolling == doctest::Approx(mu_r * mass * 9.81 * way).epsilon(1e-3).scale(0));
  CHECK(std::abs(last.sliding) < 1e-2 * last.rolling);
  CHECK(std::abs(last.balance() - at_first.balance()) < 1e-8 * last.rolling);
}

TEST_CASE("contact_work: a belt gives its force times its way, a drum its torque times its angle") {
  using law = collide::granular_contact<hertz, mindlin, collide::epsd>;
  using scene = simulation<gravity, law, work, collide::reaction, collide::moving_bodies<>, velocity_verlet>;
  double const dt = 1e-5, speed = 0.5;
  law const by{solid_of({0.3, 0.5, 0.02}), {}, tests::mindlin_of_lammps(true)};
  collide::host const space(1);
  for (bool const is_drum : {false, true}) {
    world<double> w;
    w.radius = radius;
    if (is_drum) {
      double const size = 0.05;
      for (int k = 0; k < 24; ++k) {
        double const a = 2 * pi * k / 24, b = 2 * pi * (k + 1) / 24;
        tests::add_quad(w, {size * std::cos(a), -0.05, size * std::sin(a)},
                        {size * std::cos(b), -0.05, size * std::sin(b)}, {size * std::cos(b), 0.05, size * std::sin(b)},
                        {size * std::cos(a), 0.05, size * std::sin(a)});
      }
      w.particle(0, 0, -0.03);
      w.particle(0.022, 0, -0.03);
      w.particle(-0.022, 0, -0.02);
    } else {
      tests::add_divided_floor(w, 1, 8);
      w.particle(0.01, 0.02, 1.0001 * radius);
    }
    collide::body_motion motion;
    if (is_drum) {
      motion.axis[1] = 1, motion.axis[2] = 0, motion.rate = 5;
    } else {
      motion.belt[0] = speed;
    }
    collide::reaction_sums sums(space, 1, 1e-15);
    tests::running_bodies<scene> made(space, w, tests::one_body(w, motion), gravity{}, by, of_grains(),
                                      sums.effect(density), collide::moving_bodies<>{}, velocity_verlet{});
    auto const at_first = collide::energy(made.simulation);
    made.simulation.steps(40000, dt);
    auto const last = collide::energy(made.simulation);
    auto const of_body = sums.read(space)[0];
    double const given = is_drum ? -of_body.angular[1] * 5 : -of_body.linear[0] * speed;
    CHECK(given > 0);
    CHECK(last.given == doctest::Approx(given).epsilon(1e-6).scale(0));
    CHECK(std::abs(last.balance() - at_first.balance()) < 1e-8 * last.given);
    CHECK(last.sliding > 0);
    if (!is_drum) CHECK(last.given == doctest::Approx(mass * made.velocities()[0] * speed).epsilon(1e-9).scale(0));
  }
}

TEST_CASE("contact_work: in a sheared cell of many grains the balance closes, by any law and step") {
  using solids = collide::materials<2>;
  using law = collide::granular_contact<hertz, mindlin, collide::marshall<collide::epsd>, none, solids>;
  using scene = simulation<gravity, law, collide::contact_work<solids>, collide::periodic_box, collide::moving_bodies<>,
                           velocity_verlet>;
  double const side = 0.1, high = 0.08, r = 0.008;
  for (double const part : {0.2, 1.0}) {  // of the longest good step
    world<double> w;
    w.radius = r;
    tests::add_quad(w, {-1, -1, high}, {1, -1, high}, {1, 1, high}, {-1, 1, high});
    tests::add_quad(w, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    auto const all =
        collide::fill(collide::box_region{{0, 0, 0}, {side, side, high}}, collide::size_distribution::one(r), 0.44, 1);
    for (std::size_t i = 0; i < all.radii.size(); ++i)
      w.particle(all.centres[3 * i], all.centres[3 * i + 1], all.centres[3 * i + 2]);
    collide::body floor{2, 2, {}};
    floor.motion.belt[0] = 0.5;
    solids m;
    m.set(0, {1e5, 0.3, density});
    m.set(1, {2e5, 0.3, density / 2});
    for (auto const& [i, k] : {std::pair(0, 0), std::pair(0, 1), std::pair(1, 1)}) m.set_pair(i, k, {0.3, 0.5, 0.1});
    tests::running_bodies<scene> made(
        collide::host(1), w, std::vector<collide::body>{floor}, gravity{}, law{m}, collide::contact_work<solids>{m},
        collide::periodic_box{{0, 0, -1}, {side, side, 2}}, collide::moving_bodies<>{}, velocity_verlet{});
    std::vector<std::uint8_t> which(w.size());
    for (std::size_t i = 0; i < which.size(); ++i) which[i] = static_cast<std::uint8_t>(i % 2);
    made.simulation.assign<collide::material>(which);
    auto const before = collide::energy(made.simulation);
    double const dt = collide::largest_time_step(made.simulation) * 0.8 * part;
    made.simulation.steps(static_cast<std::size_t>(0.3 / dt), dt);
    auto const after = collide::energy(made.simulation);
    CHECK(after.given > 0);
    CHECK(after.damping > 0);
    CHECK(after.sliding > 0);
    CHECK(after.rolling > 0);
    CHECK(std::abs(after.balance() - before.balance()) < 1e-10 * after.lost());
  }
}
