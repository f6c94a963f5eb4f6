// expect: collide: sphere_pairs: query gives each pair once, and any_hit would mark one of the two: use neighbours
#include <collide/detectors/sphere_pairs.cuh>

int main() {
  collide::sphere_pairs<> finder;
  finder.query(collide::sphere_view<float>(), collide::any_hit());
}
