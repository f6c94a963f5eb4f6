/// Bodies with poses on CUDA.
#include <collide/bucket.cuh>
#include <collide/bvh.cuh>

#include "streaming/posed.hpp"

using collide::bucket, collide::bvh, collide::cuda_shared, collide::detector, collide::karabassi;

TEST_CASE("posed: what a loop finds in the frames of bodies, on CUDA") {
  tests::check_posed<detector<bucket, karabassi<>, cuda_shared>>(cuda_shared());
}

TEST_CASE("posed: with half turns what a detector finds in the world, on CUDA") {
  tests::check_half_turns<detector<bucket, karabassi<>, cuda_shared>>(cuda_shared());
}

TEST_CASE("posed: inside, and the signed distance of all bodies, as each says alone, on CUDA") {
  tests::check_posed_sides<detector<bvh, karabassi<>, cuda_shared>>(cuda_shared());
}

TEST_CASE("posed: the nearest triangle of all bodies, as a loop finds it, on CUDA") {
  tests::check_posed_nearest<detector<bvh, karabassi<>, cuda_shared>>(cuda_shared());
}

TEST_CASE("posed: the k nearest triangles of all bodies, as a loop finds them, on CUDA") {
  tests::check_posed_k_nearest<detector<bvh, karabassi<>, cuda_shared>>(cuda_shared());
}

TEST_CASE("posed: impacts of spheres that move past bodies, as a loop finds them, on CUDA") {
  tests::check_posed_impacts<detector<bucket, collide::karabassi_swept<>, cuda_shared>>(cuda_shared());
}
