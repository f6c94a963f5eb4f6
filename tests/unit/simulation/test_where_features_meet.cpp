/// Where features meet, on the host and as blocks of threads go.
#include "compositions.hpp"
#include "simulation/clumps.hpp"
#include "simulation/where_features_meet.hpp"

using collide::host;
using collide::karabassi;
using collide::karabassi_swept;
using collide::semi_implicit_euler;
using collide::velocity_verlet;
using blocks = tests::lockstep<64, true>;

TEST_CASE("where features meet: what lies on the mesh presses with its weight") {
  tests::check_weights<karabassi<>, double>(host(1));
  tests::check_weights<karabassi_swept<>, float>(host(1));
  tests::check_slope_and_stack<semi_implicit_euler, double>(host(1));
  tests::check_slope_and_stack<velocity_verlet, double>(host(1));
  tests::check_slope_and_stack<velocity_verlet, float>(blocks());
}

TEST_CASE("where features meet: in the corner of bodies each has its share of the weight, asleep or not") {
  tests::check_weight_in_a_corner<karabassi<>, semi_implicit_euler, double>(host(1));
  tests::check_weight_in_a_corner<karabassi<>, velocity_verlet, float>(host(1));
  tests::check_weight_in_a_corner<karabassi<>, semi_implicit_euler, float>(blocks());
  tests::check_weight_in_a_corner<karabassi_swept<>, velocity_verlet, double>(host(1));
}

TEST_CASE("where features meet: what sleeps is woken where a parameter changes") {
  tests::check_waking_by_parameters<double>(host(1));
  tests::check_waking_by_parameters<float>(blocks());
}

TEST_CASE("where features meet: velocity Verlet is of second order with forces between particles") {
  tests::check_order_of_pair_forces(host(1));
}

TEST_CASE("where features meet: what sleeps goes with what it lies on, however slowly") {
  tests::check_slow_support<karabassi<>, double>(host(1));
  tests::check_slow_support<karabassi<>, float>(blocks());
  tests::check_slow_support<karabassi_swept<>, float>(host(1));
}

TEST_CASE("where features meet: what wakes what sleeps loses what that gets") {
  tests::check_momentum_of_waking<semi_implicit_euler, double>(host(1));
  tests::check_momentum_of_waking<semi_implicit_euler, float>(blocks());
  tests::check_momentum_of_waking<velocity_verlet, double>(host(1));
}

TEST_CASE("where features meet: what spins does not sleep, and angular momentum closes") {
  tests::check_sleep_of_what_spins<karabassi<>, double>(host(1));
  tests::check_sleep_of_what_spins<karabassi_swept<>, float>(host(1));
  tests::check_angular_momentum<karabassi<>, double>(host(1));
  tests::check_angular_momentum<karabassi<>, float>(blocks());
  tests::check_angular_momentum<karabassi_swept<>, float>(host(1));
  tests::check_angular_momentum_of_turntable<karabassi<>, float>(blocks());
  tests::check_angular_momentum_of_turntable<karabassi_swept<>, double>(host(1));
  tests::check_angular_momentum_of_riders<karabassi<>, semi_implicit_euler, double>(host(1));
  tests::check_angular_momentum_of_riders<karabassi_swept<>, velocity_verlet, double>(host(1));
  tests::check_angular_momentum_beside_sleepers<karabassi<>, semi_implicit_euler, double>(host(1));
  tests::check_angular_momentum_beside_sleepers<karabassi<>, velocity_verlet, float>(blocks());
  tests::check_angular_momentum_beside_sleepers<karabassi_swept<>, velocity_verlet, double>(host(1));
}

TEST_CASE("where features meet: spin and friction give no energy in a corner, and keep angular momentum") {
  tests::check_energy_in_a_corner<karabassi<>, double>(host(1));
  tests::check_energy_in_a_corner<karabassi<>, float>(blocks());
  tests::check_energy_in_a_corner<karabassi_swept<>, float>(host(1));
  tests::check_arms_of_spheres<double>(host(1));
  tests::check_arms_of_spheres<float>(blocks());
}

TEST_CASE("where features meet: elastic bounces in a corner of slanted walls give no energy") {
  for (double const g : {0.0, 9.81}) {
    tests::check_elastic_corner<karabassi<>, double>(host(1), g, 1e-9);
    tests::check_elastic_corner<karabassi_swept<>, double>(host(1), g, 1e-9);
  }
}

TEST_CASE("where features meet: adhesion holds against other particles, and a surface that is there") {
  tests::check_adhesion_and_others<karabassi<>, semi_implicit_euler, double>(host(1));
  tests::check_adhesion_and_others<karabassi<>, velocity_verlet, float>(blocks());
  tests::check_adhesion_and_others<karabassi_swept<>, velocity_verlet, double>(host(1));
  tests::check_adhesion_without_surface<karabassi<>, float>(blocks());
  tests::check_pairs_without_forces(host(1));
  tests::check_adhesion_without_surface<karabassi_swept<>, double>(host(1));
  tests::check_adhesion_across<karabassi<>, float>(blocks());
  tests::check_adhesion_across<karabassi_swept<>, double>(host(1));
}

TEST_CASE("where features meet: a driven body is nowhere before its first pose, and a turntable carries") {
  tests::check_driven_body_that_is_gone(host(1));
  tests::check_first_pose<karabassi<>, float>(blocks());
  tests::check_first_pose<karabassi_swept<>, double>(host(1));
  tests::check_turntable(host(1));
  tests::check_far_planes(host(1));
}

TEST_CASE("where features meet: what is nowhere is counted") {
  tests::check_lost(host(1));
  tests::check_lost(blocks());
}

TEST_CASE("where features meet: what is assigned counts as if the simulation began with it") {
  tests::check_assigned<karabassi<>, semi_implicit_euler, double>(host(1));
  tests::check_assigned<karabassi_swept<>, velocity_verlet, float>(host(1));
  tests::check_assigned<karabassi<>, velocity_verlet, float>(blocks());
}

TEST_CASE("where features meet: what sleeps on one whose place a source takes falls, and nothing else") {
  tests::check_place_of_another<double>(host(1));
  tests::check_place_of_another<float>(blocks());
  tests::check_place_far_away<semi_implicit_euler, double>(host(1));
  tests::check_place_far_away<velocity_verlet, double>(host(1));
  tests::check_place_far_away<velocity_verlet, float>(blocks());
}

TEST_CASE("where features meet: forces on spheres of clumps turn these, which flow and vanish as a whole") {
  tests::check_forces_on_clumps<double>(host(1));
  tests::check_forces_on_clumps<float>(blocks());
  tests::check_flow_of_clumps(host(1));
  tests::check_flow_of_clumps(blocks());
}

TEST_CASE("where features meet: a source makes clumps, and where a sink takes them others come") {
  tests::check_source_of_clumps<double>(host(1));
  tests::check_source_of_clumps<float>(blocks());
  tests::check_source_of_single_spheres(host(1));
  tests::check_few_clumps<double>(blocks());
}

TEST_CASE("where features meet: the energy of clumps is accounted for, and their stress holds their weight") {
  tests::check_balance_of_clumps(host(1));
  tests::check_stress_of_clumps(host(1));
}

TEST_CASE("where features meet: clumps press with their weight, go with a belt, and meet across the sides of a box") {
  tests::check_weight_of_clumps<double>(host(1));
  tests::check_weight_of_clumps<float>(blocks());
  tests::check_clumps_in_boxes(host(1));
}
