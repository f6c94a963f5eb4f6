/// Births where something is already, on a GPU.
#include "simulation/births.hpp"

TEST_CASE("births: on a GPU") {
  tests::check_births<collide::semi_implicit_euler, float>(collide::cuda_shared());
  tests::check_births<collide::velocity_verlet, double>(collide::cuda(), collide::polydisperse{});
  tests::check_births_in_one_point(collide::cuda_shared());
  tests::check_births_of_what_does_not_meet(collide::cuda_shared());
  tests::check_births_touch_nothing<float>(collide::cuda_shared(), 3, false);
}
