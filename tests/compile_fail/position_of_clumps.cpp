// expect: collide: assign: in a scene with clumps set_clumps says where spheres are, and how they move
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/clumps.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/simulation.cuh>

void run(std::vector<float> const& places) {
  using law = collide::granular_contact<collide::hertz>;
  collide::simulation<collide::detector<collide::bucket>, collide::velocity_verlet, law, collide::clumps> scene;
  scene.assign<collide::position>(places);
}
