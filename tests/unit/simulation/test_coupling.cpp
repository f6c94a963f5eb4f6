/// Coupling of a simulation with others, on the host: forces that another program writes, and the mass that flows.
#include "execution/lockstep.hpp"
#include "simulation/external_forces.hpp"
#include "simulation/mass_flow.hpp"

using collide::host;

TEST_CASE_TEMPLATE("external_forces: spheres of many sizes fly as the force on each says", S, float, double) {
  tests::check_external_forces<collide::semi_implicit_euler, S>(host(2));
  tests::check_external_forces<collide::velocity_verlet, S>(host(2));
}

TEST_CASE("external_forces: the same as blocks of threads go") {
  tests::check_external_forces<collide::velocity_verlet, float>(tests::lockstep<64, true>());
}

TEST_CASE("external_forces: masses are those of the materials") { tests::check_external_forces_of_materials(host(1)); }

TEST_CASE("external_forces: the mesh holds against them, and nothing is woken") {
  tests::check_external_forces_at_rest(host(1));
}

TEST_CASE("external_forces: a density that is none is refused") {
  for (double const density : {0., -1., std::numeric_limits<double>::infinity()}) {
    CHECK_THROWS_WITH_AS(collide::external_forces<>{{density}}.check_parameters(),
                         "collide: one_density: density is above 0, and finite", collide::error);
  }
  CHECK_NOTHROW(collide::external_forces<>{{7800}}.check_parameters());
}

TEST_CASE("external_forces: what has no mass flies on") {
  collide::simulation<collide::detector<collide::bucket>, collide::external_forces<>> made(host(1));
  float const centre[3] = {}, fast[3] = {1, 2, 3};
  made.set(collide::spheres_xyz(centre, 1, 0.0f), fast);
  made.assign<collide::external_force>(std::vector<float>{5, 0, 0});
  made.step(1e-3f);
  CHECK(made.to_host<collide::velocity>() == std::vector<float>{1, 2, 3});
}

TEST_CASE("box_walls: spheres of many sizes lie on them at their radius") { tests::check_walls_of_sizes(host(1)); }

TEST_CASE("mass_flow: each crossing of a plane or a disc counts once") {
  for (double const disc : {std::numeric_limits<double>::infinity(), 0.5}) {
    tests::check_crossings(host(2), disc);
    tests::check_crossings(tests::lockstep<64, true>(), disc);
  }
}

TEST_CASE("mass_flow: a leap of a box that repeats is no flow") {
  for (double const plane : {0.55, 0.018, 0.978}) tests::check_rounds(host(1), plane);
}

TEST_CASE_TEMPLATE("mass_flow: what stops dead far behind the plane has come through", S, float, double) {
  tests::check_stopped_behind<collide::karabassi<>, S>(host(1));
  tests::check_stopped_behind<collide::karabassi_swept<>, S>(host(1));
  tests::check_stopped_behind<collide::karabassi_swept<>, S>(tests::lockstep<64, true>());
}

TEST_CASE("mass_flow: what a source makes flows through") { tests::check_steady_flow(host(1)); }

TEST_CASE("mass_flow: what is no surface is refused") {
  host const space(1);
  collide::flow_sums const flow(space, 1e-9);
  auto const good = flow.through({0, 0, 0}, {0, 0, 1}, collide::one_density{1});
  CHECK_NOTHROW(good.check_parameters());
  auto bad = good;
  for (double const length : {0., 1e-160, 1e200, std::numeric_limits<double>::quiet_NaN()}) {
    bad.normal[2] = length;
    CHECK_THROWS_AS(bad.check_parameters(), collide::error);
  }
  bad = good;
  bad.disc = 0;
  CHECK_THROWS_AS(bad.check_parameters(), collide::error);
  CHECK_THROWS_WITH_AS(collide::mass_flow<>{}.check_parameters(),
                       "collide: mass_flow: unit is above 0, and finite, and flow_sums makes the effect",
                       collide::error);
}
