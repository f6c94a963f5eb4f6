// expect: collide: mesh and spheres must have the scalar type of the detector, its fourth parameter
#include <collide/bucket.cuh>

int main() {
  collide::detector<collide::bucket> detector;
  detector.build(collide::mesh_view<double>());
}
