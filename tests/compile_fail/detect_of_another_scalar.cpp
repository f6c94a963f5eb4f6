// expect: collide: mesh and spheres must have the scalar type of the detector, its fourth parameter
#include <collide/bucket.cuh>

int main() {
  collide::detector<collide::bucket> detector;
  detector.detect(collide::mesh_view<float>(), collide::sphere_view<double>(), collide::count());
}
