// expect: collide: the first parameter of a simulation is a detector, such as detector<bucket>
#include <collide/bucket.cuh>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

int main() { collide::simulation<collide::bucket, collide::gravity> simulation; }
