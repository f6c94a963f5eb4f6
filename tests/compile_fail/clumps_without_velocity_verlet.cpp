// expect: collide: clumps need velocity_verlet, and forces between particles
#include <collide/bucket.cuh>
#include <collide/effects/clumps.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/simulation.cuh>

void run() {
  collide::simulation<collide::detector<collide::bucket>, collide::granular_contact<collide::hertz>, collide::clumps>
      scene;
  scene.step(0.001f);
}
