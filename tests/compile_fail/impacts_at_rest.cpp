// expect: collide: impacts need a narrow phase for spheres that move
#include <collide/all_pairs.cuh>
#include <collide/sinks/impacts.hpp>

int main() {
  collide::detector<collide::all_pairs> detector;
  detector.query(collide::sphere_view<float>(), collide::impacts<float>());
}
