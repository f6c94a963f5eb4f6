#include <cstdio>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

int main() {
  float const floor[] = {-5, -5, 0, 5, -5, 0, 5, 5, 0, -5, 5, 0};
  unsigned const triangles[] = {0, 1, 2, 0, 2, 3};
  float const centres[] = {0, 0, 2, 1, 0, 3};  // metres
  collide::simulation<collide::detector<collide::bucket>, collide::gravity, collide::bounce> simulation(
      collide::host(), collide::gravity{0, 0, -9.81}, collide::bounce{0.5});
  simulation.set_mesh(collide::indexed_mesh(floor, 4, triangles, 2));
  simulation.set(collide::spheres_xyz(centres, 2, 0.25f));
  simulation.steps(5000, 0.001f);  // seconds
  auto const x = simulation.to_host<collide::position>();
  std::printf("after %.0f s the centres are %.2f and %.2f m high\n", simulation.time(), x[2], x[5]);
}
