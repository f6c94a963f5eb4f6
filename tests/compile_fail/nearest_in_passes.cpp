// expect: collide: nearest and k_nearest are of a whole mesh: not of one in passes, or divided among ranks
#include <collide/bvh.cuh>
#include <collide/in_passes.hpp>
#include <collide/sinks/nearest.hpp>

int main() {
  collide::in_passes<collide::detector<collide::bvh>> passes;
  passes.query(collide::sphere_view<float>(), collide::nearest());
}
