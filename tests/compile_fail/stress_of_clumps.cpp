// expect: collide: stress does not know clumps yet
#include <collide/bucket.cuh>
#include <collide/effects/clumps.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/simulation/stress.hpp>

void run() {
  using law = collide::granular_contact<collide::hertz>;
  collide::simulation<collide::detector<collide::bucket>, collide::velocity_verlet, law, collide::clumps> scene;
  collide::stress(scene, {0, 0, 0}, {1, 1, 1});
}
