/// Checkpoints on the GPU.
#include "compositions.hpp"
#include "simulation/checkpoint.hpp"

using collide::cuda_shared;
using collide::host;

TEST_CASE("checkpoint: on the GPU, a simulation that is loaded goes on in the same bits") {
  tests::check_scenes_go_on(cuda_shared());
  tests::check_bodies_go_on<cuda_shared, collide::karabassi<>, collide::body_motion>(cuda_shared());
  tests::check_bodies_go_on<cuda_shared, collide::karabassi_swept<>, collide::driven>(cuda_shared());
}

TEST_CASE("checkpoint: on the GPU, from one space to another, and what is not saved") {
  tests::check_other_space(host(1), cuda_shared());
  tests::check_other_space(cuda_shared(), host(1));
  tests::check_pointers_stay(cuda_shared());
}
