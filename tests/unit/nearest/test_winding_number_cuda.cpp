/// Winding numbers on a device: the bits of the host.
#include <collide/cuda.cuh>

#include "nearest/winding_queries.hpp"

TEST_CASE_TEMPLATE("winding numbers on a device: within their error of the sum, and the bits of the host", S, float,
                   double) {
  tests::check_windings<S>(collide::cuda(), 50);
  tests::check_windings<S>(collide::cuda_shared(), 10);
}
