/// Where features meet, on a GPU.
#include "simulation/where_features_meet.hpp"

using collide::cuda_shared;
using collide::karabassi;
using collide::karabassi_swept;
using collide::semi_implicit_euler;
using collide::velocity_verlet;

TEST_CASE("where features meet: on a GPU") {
  tests::check_weights<karabassi<>, float>(cuda_shared());
  tests::check_weight_in_a_corner<karabassi<>, velocity_verlet, float>(cuda_shared());
  tests::check_waking_by_parameters<float>(cuda_shared());
  tests::check_slope_and_stack<velocity_verlet, double>(cuda_shared());
  tests::check_order_of_pair_forces(cuda_shared());
  tests::check_slow_support<karabassi<>, double>(cuda_shared());
  tests::check_sleep_of_what_spins<karabassi_swept<>, float>(cuda_shared());
  tests::check_momentum_of_waking<semi_implicit_euler, float>(cuda_shared());
  tests::check_angular_momentum<karabassi<>, double>(cuda_shared());
  tests::check_adhesion_and_others<karabassi<>, velocity_verlet, float>(cuda_shared());
  tests::check_adhesion_without_surface<karabassi_swept<>, double>(cuda_shared());
  tests::check_first_pose<karabassi_swept<>, double>(cuda_shared());
  tests::check_assigned<karabassi<>, velocity_verlet, float>(cuda_shared());
  tests::check_place_of_another<double>(cuda_shared());
  tests::check_lost(cuda_shared());
}
