// expect: collide: the first argument of build is a mesh, such as indexed_mesh or triangle_soup gives
#include <collide/bucket.cuh>

int main() {
  collide::detector<collide::bucket> detector;
  detector.detect(collide::sphere_view<float>(), collide::mesh_view<float>(), collide::count());
}
