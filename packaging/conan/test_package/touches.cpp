/// Returns 0 if a sphere touches the triangle that it must touch.
#include <collide/bucket.cuh>

int main() {
  float const corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  float const centres[] = {0.2f, 0.2f, 0.4f, 2, 2, 2};
  collide::detector<collide::bucket> detector;
  detector.build(collide::triangle_soup(corners, 1));
  return detector.query(collide::spheres_xyz(centres, 2, 0.5f), collide::count()).total() == 1 ? 0 : 1;
}
