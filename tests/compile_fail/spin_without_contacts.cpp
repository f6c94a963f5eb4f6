// expect: collide: spin needs contacts that turn particles
#include <collide/bucket.cuh>
#include <collide/effects/spin.hpp>
#include <collide/simulation.cuh>

void run() {
  collide::simulation<collide::detector<collide::bucket>, collide::spin> scene;
  scene.step(0.001f);
}
