/// `automatic` on the host.
#include "automatic.hpp"
#include "compositions.hpp"

TEST_CASE("automatic: the pairs are the same, the grid is there only where it pays, on the host") {
  tests::check_automatic(collide::host(1));
  tests::check_automatic(tests::lockstep<64, true>(1));
  tests::check_automatic_swept(collide::host(1));
}

TEST_CASE("automatic: many queries of few spheres make a grid in the end, on the host") {
  tests::check_many_queries(collide::host(1));
}
