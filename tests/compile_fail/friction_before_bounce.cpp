// expect: collide: an effect comes after those whose result it uses: name friction and adhesion after bounce
#include <collide/bucket.cuh>
#include <collide/effects/friction.hpp>
#include <collide/simulation.cuh>

int main() { collide::simulation<collide::detector<collide::bucket>, collide::friction, collide::bounce> simulation; }
