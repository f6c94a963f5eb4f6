/// Effects on the GPU.
#include "simulation/effects.hpp"
#include "simulation/external_forces.hpp"
#include "simulation/mass_flow.hpp"
#include "simulation/neighbours.hpp"

using collide::cuda_shared;
using collide::karabassi;
using collide::karabassi_swept;

TEST_CASE("effects: on the GPU, drag and wind") {
  tests::check_drag(cuda_shared());
  tests::check_wind(cuda_shared());
}

TEST_CASE("effects: on the GPU, inclines") { tests::check_incline<karabassi<>>(cuda_shared()); }

TEST_CASE("effects: on the GPU, rolling") {
  tests::check_rolling<karabassi<>>(cuda_shared());
  tests::check_rolling<karabassi_swept<>>(cuda_shared());
}

TEST_CASE("effects: on the GPU, spheres that meet") {
  tests::check_collisions<float>(cuda_shared());
  tests::check_meeting_determinism(cuda_shared(), cuda_shared());
}

TEST_CASE("effects: on the GPU, particles meet those that they overlap, in the order of their numbers") {
  tests::check_neighbours<float>(cuda_shared());
  tests::check_neighbours<double>(collide::cuda());
}

TEST_CASE("effects: on the GPU, a pile of spheres stays in a closed mesh for 1e5 steps") {
  tests::check_pile(cuda_shared(), 100000, 300);
}

TEST_CASE("effects: on the GPU, sleeping and sticking") {
  tests::check_sleep(cuda_shared());
  tests::check_sleep_in_a_row(cuda_shared());
  tests::check_stick<karabassi<>>(cuda_shared());
}

TEST_CASE("effects: on the GPU, bounds, sinks and sources") {
  tests::check_bounds(cuda_shared());
  tests::check_absorb<karabassi<>>(cuda_shared());
  tests::check_emit(cuda_shared());
  tests::check_rates<float>(cuda_shared());
  tests::check_source_radius(cuda_shared());
}

TEST_CASE("effects: on the GPU, forces that another program writes") {
  tests::check_external_forces<collide::velocity_verlet, float>(cuda_shared());
  tests::check_external_forces<collide::semi_implicit_euler, double>(cuda_shared());
  tests::check_external_forces_of_materials(cuda_shared());
  tests::check_external_forces_at_rest(cuda_shared());
  tests::check_walls_of_sizes(cuda_shared());
}

TEST_CASE("effects: on the GPU, mass that flows through a surface") {
  tests::check_crossings(cuda_shared(), 0.5);
  tests::check_rounds(cuda_shared(), 0.018);
  tests::check_steady_flow(cuda_shared());
}
