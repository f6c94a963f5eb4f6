/// Clumps, on the host and as blocks of threads go.
#include "compositions.hpp"
#include "simulation/clumps.hpp"

using collide::host;
using blocks = tests::lockstep<64, true>;

TEST_CASE("clumps: shapes have volumes and moments of closed forms") { tests::check_shapes(host(1)); }

TEST_CASE("clumps: a free top keeps its angular momentum and its energy") {
  tests::check_free_top<double>(host(1), 100'000);
  tests::check_free_top<float>(host(1), 10'000);
  tests::check_order_of_tops(host(1));
}

TEST_CASE("clumps: one sphere is a sphere") {
  tests::check_sphere_as_clump<double>(host(1));
  tests::check_sphere_as_clump<float>(blocks());
  tests::check_ball_with_core(host(1));
}

TEST_CASE("clumps: impact of a dumbbell, a rod on a slope, and momentum that closes") {
  tests::check_dumbbell_impact(host(1));
  tests::check_rod_on_slope(host(1));
  tests::check_restitution_of_clumps(host(1));
  tests::check_momentum_of_clumps<collide::granular_contact<collide::hertz, collide::mindlin>>(host(1));
  tests::check_momentum_of_clumps<collide::granular_contact<collide::linear, collide::dashpot>>(blocks());
}

TEST_CASE("clumps: the same bits in every space, and after a checkpoint") {
  tests::check_same_clumps<double>(host(2));
  tests::check_same_clumps<float>(host(1));
  tests::check_same_clumps<double, collide::external_forces<>, collide::absorbing_box>(blocks());
  tests::check_same_clumps<float>(blocks());
}

TEST_CASE("clumps: their energy stays where nothing takes it") { tests::check_energy_of_clumps(host(1)); }

TEST_CASE("clumps: what lies still sleeps as one, until something falls on it or the floor moves") {
  tests::check_sleep_of_clumps<double>(host(1));
  tests::check_sleep_of_clumps<float>(blocks());
  tests::check_each_sphere_wakes(host(1));
  tests::check_clumps_asleep_on_bodies<double>(host(1));
  tests::check_weight_of_sleeping_clumps<double>(host(1));
  tests::check_weight_of_sleeping_clumps<float>(blocks());
  tests::check_same_sleeping_clumps<double>(host(2));
  tests::check_same_sleeping_clumps<float>(blocks());
}

TEST_CASE("clumps: they vanish as a whole where one of their spheres meets a sink") {
  tests::check_sink_of_clumps(host(1));
  tests::check_sink_of_clumps(blocks());
}
