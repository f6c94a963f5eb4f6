// expect: collide: clumps are on one rank
#include <collide/bucket.cuh>
#include <collide/effects/clumps.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/ranks/distributed_simulation.cuh>
#include <collide/ranks/thread_ranks.hpp>

void run() {
  using law = collide::granular_contact<collide::hertz>;
  using scene = collide::simulation<collide::detector<collide::bucket>, collide::velocity_verlet, law, collide::clumps>;
  collide::distributed<scene, collide::one_rank> parts;
  parts.step(0.001f);
}
