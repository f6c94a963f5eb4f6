// expect: collide: a simulation has one integrator
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

int main() {
  collide::simulation<collide::detector<collide::bucket>, collide::velocity_verlet, collide::semi_implicit_euler>
      simulation;
}
