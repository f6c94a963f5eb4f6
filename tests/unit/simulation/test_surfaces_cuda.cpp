/// Walls of granular contact are surfaces, on a GPU.
#include <collide/cuda.cuh>

#include "compositions.hpp"
#include "simulation/surfaces.hpp"

using collide::cuda_shared;

TEST_CASE("surfaces: short facets and folds that get flat, on a GPU") {
  tests::check_smooth_surfaces(cuda_shared());
  tests::check_flat_folds(cuda_shared());
}

TEST_CASE("surfaces: pieces of a wall are one flat wall, on a GPU") {
  tests::check_force_at_seams(cuda_shared());
  tests::check_motion_over_seams(cuda_shared());
  tests::check_features_on_pieces(cuda_shared());
}

TEST_CASE("surfaces: a fan of many triangles finds room, on a GPU") { tests::check_fan(cuda_shared(), 2000); }

TEST_CASE("surfaces: folds and troughs make no energy, on a GPU") {
  tests::check_energy_in_folds(cuda_shared(), 64);
  tests::check_energy_in_troughs(cuda_shared(), 0.1);
}

TEST_CASE("surfaces: the same bits on a GPU") {
  tests::check_same_surfaces<double>(cuda_shared(), 16, 200, 300);
  tests::check_same_surfaces<float>(cuda_shared(), 16, 200, 300);
}

TEST_CASE("few: grains on pieces of a wall, on the GPU") {
  tests::check_same_surfaces<double>(cuda_shared(), 6, 24, 4);
}
