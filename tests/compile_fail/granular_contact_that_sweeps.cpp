// expect: collide: granular_contact, and other effects that press on the mesh by forces, see it where a step ends
#include <collide/bucket.cuh>
#include <collide/effects/granular_contact.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation.cuh>

void run() {
  using law = collide::granular_contact<collide::hertz>;
  collide::simulation<collide::detector<collide::bucket, collide::karabassi_swept<>>, law> scene;
  scene.step(0.001f);
}
