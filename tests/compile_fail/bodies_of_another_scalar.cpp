// expect: collide: particles, their velocities and the mesh must have the scalar type
#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/simulation.cuh>

int main() {
  collide::simulation<collide::detector<collide::bucket>, collide::bounce, collide::moving_bodies<>> simulation;
  double corners[9] = {};
  simulation.set_mesh(collide::triangle_soup(static_cast<double const*>(corners), 1), {collide::body{0, 1, {}}});
}
