/// Pairs of spheres on CUDA.
#include "neighbours/sphere_pairs.hpp"

using collide::cuda_shared;

TEST_CASE_TEMPLATE("sphere pairs: all that touch, as the oracle has them, on CUDA", S, float, double) {
  tests::check_sphere_pairs<cuda_shared, S>(cuda_shared());
  tests::check_sphere_pairs<collide::cuda, S>(collide::cuda());
}

TEST_CASE("sphere pairs: nothing is allocated once there is room, on CUDA") {
  tests::counting_resource memory(collide::cuda_memory::get());
  tests::check_sphere_pairs_allocate_once(cuda_shared(nullptr, &memory), memory);
}
