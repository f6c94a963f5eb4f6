// expect: collide: clumps press on the mesh by the forces of granular_contact
#include <collide/bucket.cuh>
#include <collide/effects/absorb.hpp>
#include <collide/effects/clumps.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/simulation.cuh>

void run() {
  collide::simulation<collide::detector<collide::bucket>, collide::velocity_verlet, collide::sphere_contact,
                      collide::absorb, collide::clumps>
      scene;
  scene.step(0.001f);
}
