// expect: collide: contacts<S> and impacts<S> must have the scalar type of the detector
#include <collide/bucket.cuh>

void f(collide::detector<collide::bucket>& detector, collide::sphere_view<float> spheres) {
  detector.query(spheres, collide::contacts<double>());
}
