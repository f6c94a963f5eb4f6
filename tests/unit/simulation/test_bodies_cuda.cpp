/// Bodies that move, on the GPU.
#include "simulation/moving_walls.hpp"
#include "simulation/reaction.hpp"

using collide::cuda_shared;
using collide::karabassi;
using collide::karabassi_swept;

TEST_CASE("bodies: on the GPU, belts and pistons") {
  tests::check_belt<karabassi<>, float>(cuda_shared());
  tests::check_belt<karabassi_swept<>, float>(cuda_shared());
  tests::check_piston<karabassi<>, float>(cuda_shared());
  tests::check_piston<karabassi_swept<>, double>(cuda_shared());
}

TEST_CASE("bodies: on the GPU, a floor that is shaken, a turntable and a drum") {
  tests::check_vibrated_floor<karabassi<>>(cuda_shared());
  tests::check_turntable<karabassi<>>(cuda_shared());
  tests::check_turntable<karabassi_swept<>>(cuda_shared());
  tests::check_axes(cuda_shared());
  tests::check_drum<karabassi<>>(cuda_shared());
}

TEST_CASE("bodies: on the GPU, a closed box that turns and shakes keeps what is in it") {
  tests::check_turning_box<karabassi<>, float>(cuda_shared(), 1, 1e-3, 10000, 10000);
  tests::check_turning_box<karabassi_swept<>, float>(cuda_shared(), 10, 1e-2, 10000, 10000);
}

TEST_CASE("bodies: on the GPU, what lies in the corner of a box, or on a falling plate") {
  tests::check_corner_of_turning_box<float>(cuda_shared());
  tests::check_floor_below_falling_plate<float>(cuda_shared());
}

TEST_CASE("hunt: bodies: on the GPU, a closed box that turns and shakes keeps 1e6 balls for 1e5 steps") {
  tests::check_turning_box<karabassi<>, float>(cuda_shared(), 1, 1e-3, 1000000, 100000);
}

TEST_CASE("hunt: bodies: on the GPU, a closed box that turns and shakes keeps 1e6 swept balls for 1e5 steps") {
  tests::check_turning_box<karabassi_swept<>, float>(cuda_shared(), 1, 1e-3, 1000000, 100000);
}

TEST_CASE("hunt: bodies: on the GPU, a closed box that turns by a third of a radian a step keeps 1e6 swept balls") {
  tests::check_turning_box<karabassi_swept<>, float>(cuda_shared(), 10, 1e-2, 1000000, 1000);
}

TEST_CASE("bodies: on the GPU, riding, waking, many bodies, and the same bits on every run") {
  tests::check_riding<karabassi<>>(cuda_shared());
  tests::check_waking<karabassi<>>(cuda_shared());
  tests::check_several_bodies<karabassi_swept<>>(cuda_shared());
  tests::check_same_bits<karabassi<>>(cuda_shared(), cuda_shared());
  tests::check_same_bits<karabassi_swept<>>(cuda_shared(), cuda_shared());
}

TEST_CASE("moving walls: on the GPU, a mesh set again, slow bodies, functions of one's own, a screw, and work") {
  tests::check_wall_set_again<karabassi<>, float>(cuda_shared(), 0.2);
  tests::check_slow_wall<karabassi<>, double>(cuda_shared(), 0.001);
  tests::check_own_motion<karabassi<>>(cuda_shared());
  tests::check_screw<karabassi<>>(cuda_shared());
  tests::check_work<karabassi<>>(cuda_shared());
  tests::check_momentum_of_turning_box(cuda_shared());
  tests::check_deforming<karabassi<>, float>(cuda_shared());
}

TEST_CASE("reaction: on the GPU, what sums cannot hold is counted, or an error, and never in them") {
  tests::check_sums_that_do_not_fit(cuda_shared());
}
