// expect: collide: k_nearest, contains, signed_distance and winding_number are of a whole mesh: not of one in passes
#include <collide/bvh.cuh>
#include <collide/detectors/in_passes.hpp>
#include <collide/sinks/contains.hpp>

int main() {
  collide::in_passes<collide::detector<collide::bvh>> passes;
  passes.query(collide::sphere_view<float>(), collide::contains());
}
