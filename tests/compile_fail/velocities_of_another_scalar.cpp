// expect: collide: particles, their velocities and the mesh must have the scalar type of the simulation's detector
#include <collide/bucket.cuh>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

void f(double const* velocities) {
  collide::simulation<collide::detector<collide::bucket>, collide::gravity> simulation;
  simulation.set(collide::sphere_view<float>(), velocities);
}
