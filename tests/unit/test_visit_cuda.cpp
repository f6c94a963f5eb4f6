/// Functions called for each hit, on the device: objects, and lambdas of nvcc --extended-lambda.
#include "visit.hpp"

namespace tests {

using hit_type = collide::hit<collide::karabassi<>, float>;

// nvcc wants extended lambdas in functions that have a name

auto make_generic_lambda(sums* to) {
  return [to] __device__(auto const& hit) { add_up{to}(hit); };
}

auto make_plain_lambda(sums* to) {
  return [to] __device__(hit_type const& hit) { add_up{to}(hit); };
}

auto make_lambda_for_both(sums* to) {
  return [to] __host__ __device__(hit_type const& hit) { add_up{to}(hit); };
}

template <class Space>
void check_lambdas(Space const& space) {
  crowded_scene<Space> scene(space);
  auto const expected = scene.visit([](sums* to) { return add_up{to}; });
  for (auto const& found :
       {scene.visit(make_generic_lambda), scene.visit(make_plain_lambda), scene.visit(make_lambda_for_both)}) {
    CHECK(found.hits == expected.hits);
    CHECK(found.spheres == expected.spheres);
    CHECK(found.depth == expected.depth);
  }
}

}  // namespace tests

TEST_CASE("visit: sums of many threads are whole and do not depend on the order on the device") {
  tests::check_sums(collide::cuda());
  tests::check_sums(collide::cuda_shared());
}

TEST_CASE("visit: lambdas are called on the device") {
  tests::check_lambdas(collide::cuda());
  tests::check_lambdas(collide::cuda_shared());
}

TEST_CASE("visit: a lambda for host and device is called on the host") {
  tests::crowded_scene<collide::host> scene(collide::host(2));
  auto const expected = scene.visit([](tests::sums* to) { return tests::add_up{to}; });
  CHECK(scene.visit(tests::make_lambda_for_both).depth == expected.depth);
}
