// expect: collide: friction and adhesion act where the mesh is solid
#include <collide/bucket.cuh>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

void run() {
  collide::simulation<collide::detector<collide::bucket>, collide::gravity, collide::friction> scene;
  scene.step(0.001f);
}
