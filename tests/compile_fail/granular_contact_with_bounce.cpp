// expect: collide: granular_contact makes the mesh solid by forces: leave out bounce, friction, adhesion and spin
#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/simulation.cuh>

void run() {
  using law = collide::granular_contact<collide::hertz>;
  collide::simulation<collide::detector<collide::bucket>, law, collide::bounce> scene;
  scene.step(0.001f);
}
