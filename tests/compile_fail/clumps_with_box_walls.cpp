// expect: collide: clumps: an effect that moves particles when a step begins or ends, such as box_walls
#include <collide/bucket.cuh>
#include <collide/effects/bounds.hpp>
#include <collide/effects/clumps.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/simulation.cuh>

void run() {
  using law = collide::granular_contact<collide::hertz>;
  collide::simulation<collide::detector<collide::bucket>, collide::velocity_verlet, law, collide::box_walls,
                      collide::clumps>
      scene;
  scene.step(0.001f);
}
