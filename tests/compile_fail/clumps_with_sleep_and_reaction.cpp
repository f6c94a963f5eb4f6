// expect: collide: clumps: how sleeping ones press on the mesh is not known to reaction
#include <collide/bucket.cuh>
#include <collide/effects/clumps.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/simulation.cuh>

void run() {
  using law = collide::granular_contact<collide::hertz>;
  collide::simulation<collide::detector<collide::bucket>, collide::velocity_verlet, law, collide::sleep,
                      collide::reaction, collide::clumps>
      scene;
  scene.step(0.001f);
}
