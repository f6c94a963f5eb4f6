// expect: collide: the first argument of query is spheres, such as spheres_xyz gives, and the second a sink
#include <collide/bucket.cuh>

int main() {
  collide::detector<collide::bucket> detector;
  detector.query(collide::mesh_view<float>(), collide::count());
}
