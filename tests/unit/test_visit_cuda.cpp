/// Functions called for each hit, on the device: objects, and lambdas of nvcc --extended-lambda.
#include "visit.hpp"

namespace tests {

using hit_type = collide::hit<collide::karabassi<>, float>;

void check_same(sums const& found, sums const& expected) {
  CHECK(found.hits == expected.hits);
  CHECK(found.spheres == expected.spheres);
  CHECK(found.depth == expected.depth);
}

template <class Space>
void check_lambdas(Space const& space) {
  crowded_scene<Space> scene(space);
  sums const expected = scene.end(add_up{scene.begin()});
  sums* const to = scene.begin();
  check_same(scene.end([to] __device__(auto const& hit) { add_up{to}(hit); }), expected);
  scene.begin();
  check_same(scene.end([to] __device__(hit_type const& hit) { add_up{to}(hit); }), expected);
  scene.begin();
  check_same(scene.end([to] __host__ __device__(hit_type const& hit) { add_up{to}(hit); }), expected);
}

/// A lambda for host and device, on the host.
void check_lambda_on_host() {
  crowded_scene<collide::host> scene(collide::host(2));
  sums const expected = scene.end(add_up{scene.begin()});
  sums* const to = scene.begin();
  check_same(scene.end([to] __host__ __device__(hit_type const& hit) { add_up{to}(hit); }), expected);
}

}  // namespace tests

TEST_CASE("visit: sums of many threads are whole and do not depend on the order on the device") {
  tests::check_sums(collide::cuda());
  tests::check_sums(collide::cuda_shared());
}

TEST_CASE("visit: extended lambdas are called on the device") {
  tests::check_lambdas(collide::cuda());
  tests::check_lambdas(collide::cuda_shared());
}

TEST_CASE("visit: an extended lambda for host and device is called on the host") { tests::check_lambda_on_host(); }
