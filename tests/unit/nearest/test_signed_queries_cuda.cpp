/// Inside and signed distance on a device: the bits of the host.
#include <collide/cuda.cuh>

#include "nearest/signed_queries.hpp"

TEST_CASE_TEMPLATE("signed queries on a device: the bits of the host", S, float, double) {
  tests::check_signed_queries<collide::bvh, S>(collide::cuda(), 1000);
  tests::check_signed_queries<collide::bvh, S>(collide::cuda_shared(), 1000);
  tests::check_signed_queries<collide::all_pairs, S>(collide::cuda(), 200);
  tests::check_signed_queries_of_needles<collide::bvh, S>(collide::cuda_shared(), 1000);
}

TEST_CASE_TEMPLATE("signed queries on a device: situations of public threads, and what is unusual", S, float, double) {
  tests::check_known_situations<collide::bvh, S>(collide::cuda());
  tests::check_known_situations<collide::all_pairs, S>(collide::cuda_shared());
  tests::check_unusual_signed_queries<collide::bvh, S>(collide::cuda());
}
