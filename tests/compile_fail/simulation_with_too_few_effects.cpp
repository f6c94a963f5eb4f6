// expect: collide: a simulation is made of a space, the options of the broad phase if there are any, and the parameters
#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

int main() {
  collide::simulation<collide::detector<collide::bucket>, collide::gravity, collide::bounce> simulation{
      collide::host(), collide::gravity()};
}
