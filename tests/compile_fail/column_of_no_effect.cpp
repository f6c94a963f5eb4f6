// expect: collide: no effect of this simulation names the column, so it does not have it
#include <collide/bucket.cuh>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

int main() {
  collide::simulation<collide::detector<collide::bucket>, collide::gravity> simulation;
  simulation.to_host<collide::angular_velocity>();
}
