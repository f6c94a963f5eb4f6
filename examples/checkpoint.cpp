/// \file
/// Saves a simulation to a file, and goes on from it, as another process would.

#include <cstdio>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/simulation/checkpoint.hpp>

using balls = collide::simulation<collide::detector<collide::bucket>, collide::gravity, collide::bounce>;

constexpr float floor_corners[] = {-9, -9, 0, 9, -9, 0, 0, 9, 0};
constexpr float above[] = {0, 0, 1};

int main() {
  char const* const file = "example.checkpoint";
  for (int day = 1; day <= 3; ++day) {
    balls simulation;
    simulation.set_mesh(collide::triangle_soup(floor_corners, 1));  // as it was: it is not in the file
    if (day == 1) {
      simulation.set(collide::spheres_xyz(above, 1, 0.1f));
    } else {
      collide::load(simulation, file);  // in place of set
    }
    simulation.steps(1000, 3e-4f);
    collide::save(simulation, file);  // what was there stays until this one is complete
    std::printf("%.1f s: %.3f m\n", simulation.time(), double{simulation.to_host<collide::position>()[2]});
  }
  std::remove(file);
}
