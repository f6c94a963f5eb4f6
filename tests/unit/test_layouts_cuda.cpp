/// Meshes and spheres in every layout, on the device.
#include "layouts.hpp"

TEST_CASE("layouts: each gives the contacts of the packed one on the device") {
  tests::check_layouts<collide::bucket, float>(collide::cuda_shared());
  tests::check_layouts<collide::bucket, double>(collide::cuda());
  tests::check_layouts<collide::all_pairs, float>(collide::cuda_shared());
}

TEST_CASE("layouts: each is uploaded as a packed copy on the device") {
  tests::check_uploaded_layouts<float>(collide::cuda_shared());
}

TEST_CASE("layouts: spheres that move in each give the impacts of the packed ones on the device") {
  tests::check_moving_layouts<collide::bucket, float>(collide::cuda_shared());
}
