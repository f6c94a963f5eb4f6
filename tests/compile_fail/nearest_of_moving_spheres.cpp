// expect: collide: nearest, contains, signed_distance and winding_number are for points and spheres that rest
#include <collide/bvh.cuh>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/nearest.hpp>

int main() {
  collide::detector<collide::bvh, collide::karabassi_swept<>> detector;
  detector.query(collide::moving_sphere_view<float>(), collide::nearest());
}
