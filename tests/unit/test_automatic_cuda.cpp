/// `automatic` in the CUDA spaces.
#include "automatic.hpp"

TEST_CASE("automatic: the pairs are the same, the grid is there only where it pays, on the device") {
  tests::check_automatic(collide::cuda());
  tests::check_automatic(collide::cuda_shared());
}

TEST_CASE("automatic: small scenes have the same pairs by whichever way, on the device") {
  tests::check_automatic_scenes(collide::cuda());
  tests::check_automatic_scenes(collide::cuda_shared());
}

TEST_CASE("automatic: a simulation has the bits of one with buckets, on the device") {
  tests::check_automatic_steps<collide::karabassi<>>(collide::cuda());
  tests::check_automatic_steps<collide::karabassi<>>(collide::cuda_shared());
  tests::check_automatic_steps<collide::karabassi_swept<>>(collide::cuda_shared());
}
