/// `automatic` in the CUDA spaces.
#include "automatic.hpp"

TEST_CASE("automatic: the pairs are the same, the grid is there only where it pays, on the device") {
  tests::check_automatic(collide::cuda());
  tests::check_automatic(collide::cuda_shared());
}
