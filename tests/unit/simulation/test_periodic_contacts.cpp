/// Particles that meet across the sides of a box that repeats.
#include <collide/simulation/energy.hpp>

#include "compositions.hpp"
#include "simulation/periodic_contacts.hpp"

using collide::host;
using blocks = tests::lockstep<64, true>;

TEST_CASE("periodic contacts: three across each side, edge and corner do what they do in the middle") {
  tests::check_contacts_across<double>(host(1));
  tests::check_contacts_across<float>(blocks());
}

TEST_CASE("periodic contacts: who meets whom, against all pairs") {
  tests::check_neighbours_across<double>(host(1));
  tests::check_neighbours_across<float>(blocks());
}

TEST_CASE("periodic contacts: a gas keeps its momentum, and its bits everywhere") {
  tests::check_gas_across<double>(host(2));
  tests::check_gas_across<float>(blocks());
}

TEST_CASE("periodic contacts: grains sleep, and wake each other") { tests::check_sleep_across<double>(host(1)); }

TEST_CASE("periodic contacts: energy and reports know them") {
  using namespace collide;
  using simulation = collide::simulation<tests::meets_mesh<host, karabassi<>, double>, sphere_contact, periodic_box>;
  tests::world<double> w;
  w.radius = 0.125;
  for (double const x : {0.0625, 3.9375})
    for (double const y : {0.0625, 3.9375}) w.particle(x, y, 2);
  w.particle(-4 + 0.0625, 3.9375, 2.1875);  // comes in at its first step
  tests::running<simulation> made(host(1), w, sphere_contact{8}, periodic_box{{0, 0, 0}, {4, 4, 4}});
  double const side = 0.125 * 0.125, corner = 0.25 - std::sqrt(2) * 0.125, above = 0.0625 * 0.0625,
               aside = 0.25 - std::sqrt(0.125 * 0.125 + 0.1875 * 0.1875);
  CHECK(energy(made.simulation).elastic ==
        doctest::Approx(4 * (4 * side + 2 * corner * corner + above + 2 * aside * aside)));
  CHECK(contact_report(made.simulation).contacts == 9);
}

TEST_CASE("periodic contacts: sides that are too short are an error") {
  using namespace collide;
  using simulation = collide::simulation<tests::meets_mesh<host>, sphere_contact, periodic_box>;
  tests::world<float> w;
  w.radius = 0.1f;
  w.particle(0, 0, 0);
  tests::running<simulation> made(host(1), w, sphere_contact{10}, periodic_box{{-1, -1, 0}, {1, 1, 0.44}});
  CHECK_THROWS_WITH_AS(made.simulation.step(1e-3f),
                       "collide: periodic_box: particles meet across its sides, and so each must be at least 0.441719 "
                       "long, two diameters of the largest with the skin of its neighbours, or a clump: make the box "
                       "larger, or the particles smaller",
                       collide::error);
  made.simulation.effect<periodic_box>().upper[2] = 0.442;
  CHECK_NOTHROW(made.simulation.step(1e-3f));
  // another box is seen at once, though nothing has moved
  w.particle(0, 0, 0.35);
  made.place(w);
  made.simulation.step(1e-3f);
  CHECK(made.velocities()[2] > 0);
  made.simulation.effect<periodic_box>().upper[2] = 2;
  made.place(w);
  made.simulation.step(1e-3f);
  CHECK(made.velocities()[2] == 0);
  made.simulation.effect<periodic_box>().upper[2] = 0.5;
  made.simulation.step(1e-3f);
  CHECK(made.velocities()[2] > 0);
}

TEST_CASE("periodic box: bounds that floats do not tell apart, or that are too large for them, are an error") {
  using namespace collide;
  using simulation = collide::simulation<tests::meets_mesh<host>, periodic_box>;
  tests::world<float> w;
  w.particle(1e8, 0, 0);
  for (auto const& box : {periodic_box{{1e8, 0, 0}, {1e8 + 1, 1, 1}}, periodic_box{{0, 0, 0}, {1, 1, 1e300}}}) {
    tests::running<simulation> made(host(1), w, box);
    CHECK_THROWS_WITH_AS(made.simulation.step(1e-3f),
                         "collide: periodic_box: the bounds are finite and differ in the simulation's type of numbers",
                         collide::error);
  }
}
