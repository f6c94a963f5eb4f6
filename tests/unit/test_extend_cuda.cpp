/// Policies of a user, in the spaces of a GPU.
#include "custom_policies.hpp"

using users = collide::per_sphere<bounding_spheres>;

TEST_CASE_TEMPLATE("extending: a broad phase that enumerates candidates, on CUDA", S, float, double) {
  tests::check_custom_broad_phase<users, S>(collide::cuda());
  tests::check_custom_broad_phase<collide::bvh, S>(collide::cuda());
  tests::check_custom_broad_phase<users, S>(collide::cuda_shared());
  tests::check_custom_broad_phase<collide::bvh, S>(collide::cuda_shared());
}
