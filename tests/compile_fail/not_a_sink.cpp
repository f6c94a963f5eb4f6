// expect: collide: the second argument of query is a sink
#include <collide/bucket.cuh>

void f(collide::detector<collide::bucket>& detector, collide::sphere_view<float> spheres) {
  detector.query(spheres, 42);
}
