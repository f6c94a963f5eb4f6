// expect: collide: what contacts remember does not go from rank to rank
#include <collide/bucket.cuh>
#include <collide/effects/granular_contact.hpp>
#include <collide/ranks/distributed_simulation.cuh>
#include <collide/ranks/ranks.hpp>

void run() {
  using law = collide::granular_contact<collide::hertz, collide::mindlin>;
  using scene = collide::simulation<collide::detector<collide::bucket>, law>;
  collide::distributed<scene, collide::one_rank> parts{collide::one_rank{}};
  parts.step(0.001f);
}
