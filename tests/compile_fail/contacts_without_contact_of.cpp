// expect: collide: contacts need a narrow phase with a static member contact_of(triangle, sphere)
#include <collide/bucket.cuh>

struct narrow {
  static bool intersects(collide::triangle<float> const&, collide::sphere<float> const&) { return true; }
};
void f(collide::detector<collide::bucket, narrow>& detector, collide::sphere_view<float> spheres) {
  detector.query(spheres, collide::contacts<float>());
}
