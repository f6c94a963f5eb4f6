/// Granular contact on a GPU.
#include <collide/cuda.cuh>

#include "compositions.hpp"
#include "simulation/granular_ledgers.hpp"
#include "simulation/periodic_contacts.hpp"

using collide::cuda_shared;

TEST_CASE("granular contact: two bodies to the digits of other codes, on a GPU") {
  tests::check_hertz_rebound(cuda_shared());
  tests::check_oblique_pair(cuda_shared());
  tests::check_pulled_ball(cuda_shared());
}

TEST_CASE("granular contact: a wall does not depend on its triangles, on a GPU") {
  tests::check_divided_walls<double>(cuda_shared());
  tests::check_divided_walls<float>(cuda_shared());
}

TEST_CASE("granular contact: contacts remember the same as on the host, and after a checkpoint, on a GPU") {
  tests::check_same_grains<double>(cuda_shared());
  tests::check_same_grains<float>(cuda_shared());
}

TEST_CASE("granular contact: springs of walls hold energy, on a GPU") { tests::check_energy_at_walls(cuda_shared()); }

TEST_CASE("granular contact: walls that move take grains along, and feel them, on a GPU") {
  tests::check_moving_walls<double>(cuda_shared());
  tests::check_moving_walls<float>(cuda_shared());
}

TEST_CASE("granular contact: grains sleep and press on, on a GPU") {
  tests::check_sleeping_grains<double>(cuda_shared());
  tests::check_sleep_on_bodies<collide::velocity_verlet, double>(cuda_shared());
  tests::check_weight_of_naps<collide::velocity_verlet, double>(cuda_shared());
  tests::check_first_pose_of_walls<float>(cuda_shared());
}

TEST_CASE("granular contact: what grains lose bodies get, and meetings between steps change nothing, on a GPU") {
  tests::check_ledgers<collide::velocity_verlet, double>(cuda_shared());
  tests::check_meetings_between_steps<collide::velocity_verlet, double>(cuda_shared());
  tests::check_sleep_needs_contact<collide::velocity_verlet, double>(cuda_shared());
}

TEST_CASE("granular contact: contacts find room for what they remember, or an error, on a GPU") {
  tests::check_many_neighbours<double>(cuda_shared());
}

TEST_CASE("periodic contacts: the same on a GPU") {
  tests::check_contacts_across<double>(cuda_shared());
  tests::check_neighbours_across<float>(cuda_shared());
  tests::check_gas_across<double>(cuda_shared());
  tests::check_sleep_across<double>(cuda_shared());
}
