/// Policies of a user, in the spaces of a GPU.
#include "custom_policies.hpp"

TEST_CASE_TEMPLATE("extending: a broad phase that enumerates candidates, on CUDA", S, float, double) {
  tests::check_custom_broad_phase<S>(collide::cuda());
  tests::check_custom_broad_phase<S>(collide::cuda_shared());
}
