/// The sink `nearest` on CUDA.
#include "nearest/nearest_queries.hpp"

using collide::all_pairs, collide::bvh, collide::cuda_shared;

TEST_CASE_TEMPLATE("nearest: what a loop over all triangles finds, to the last bit, on CUDA", S, float, double) {
  tests::check_nearest<bvh, cuda_shared, S>(cuda_shared());
  tests::check_nearest<bvh, collide::cuda, S>(collide::cuda());
  tests::check_nearest<all_pairs, cuda_shared, S>(cuda_shared());
}

TEST_CASE_TEMPLATE("k nearest: each is the nearest of those that are left, to the last bit, on CUDA", S, float,
                   double) {
  tests::check_k_nearest<bvh, cuda_shared, S>(cuda_shared());
}

TEST_CASE("nearest: plain arithmetic finds what is about as near, on CUDA") {
  tests::check_plain_nearest<collide::single_precision, cuda_shared, float>(cuda_shared());
  tests::check_plain_nearest<collide::double_precision, cuda_shared, double>(cuda_shared());
}

TEST_CASE("nearest: nothing is allocated once there is room, on CUDA") {
  tests::counting_resource memory(collide::cuda_memory::get());
  tests::check_nearest_allocates_once<bvh>(cuda_shared(nullptr, &memory), memory);
}
