/// Spheres that move, on the GPU.
#include "swept_queries.hpp"

TEST_CASE("swept queries: on the GPU, floats") {
  tests::check_motions<float>(collide::cuda());
  tests::check_motions<float>(collide::cuda_shared());
}

TEST_CASE("few: spheres that move, on the GPU") { tests::check_few_motions<float>(collide::cuda_shared()); }
