/// Clumps on a GPU.
#include <collide/cuda.cuh>

#include "compositions.hpp"
#include "simulation/clumps.hpp"

using collide::cuda_shared;

TEST_CASE("clumps: a free top keeps its angular momentum and its energy, on a GPU") {
  tests::check_free_top<double>(cuda_shared(), 10'000);
}

TEST_CASE("clumps: one sphere is a sphere, on a GPU") { tests::check_sphere_as_clump<float>(cuda_shared()); }

TEST_CASE("clumps: the same bits as on the host, and after a checkpoint, on a GPU") {
  tests::check_same_clumps<double>(cuda_shared());
  tests::check_same_clumps<float>(cuda_shared());
}

TEST_CASE("clumps: a bed sleeps and wakes with the bits of the host, and presses with its weight, on a GPU") {
  tests::check_same_sleeping_clumps<float>(cuda_shared());
  tests::check_weight_of_sleeping_clumps<double>(cuda_shared());
  tests::check_sink_of_clumps(cuda_shared());
}

TEST_CASE("few: clumps beside all effects that know them, on the GPU") {
  tests::check_few_clumps<float>(cuda_shared());
}
