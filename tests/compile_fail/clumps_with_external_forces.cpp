// expect: collide: clumps: an effect that accelerates them, as one particle at the centre, knows nothing but motion
#include <collide/bucket.cuh>
#include <collide/effects/clumps.hpp>
#include <collide/effects/external_forces.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/simulation.cuh>

void run() {
  using law = collide::granular_contact<collide::hertz>;
  collide::simulation<collide::detector<collide::bucket>, collide::velocity_verlet, law, collide::external_forces<>,
                      collide::clumps>
      scene;
  scene.step(0.001f);
}
