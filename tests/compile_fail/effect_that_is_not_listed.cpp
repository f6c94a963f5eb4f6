// expect: gives the parameters of an effect that is in the simulation
#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/friction.hpp>
#include <collide/simulation.cuh>

void run() {
  collide::simulation<collide::detector<collide::bucket>, collide::bounce> scene;
  scene.effect<collide::friction>().static_coefficient = 1;
}
