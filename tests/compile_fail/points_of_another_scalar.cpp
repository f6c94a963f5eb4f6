// expect: collide: mesh and spheres must have the scalar type of the detector
#include <collide/bvh.cuh>
#include <collide/sinks/nearest.hpp>

int main() {
  collide::detector<collide::bvh> detector;
  detector.query(collide::point_view<double>(), collide::nearest());
}
