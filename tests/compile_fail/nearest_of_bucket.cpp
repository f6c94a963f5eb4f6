// expect: collide: nearest, contains, signed_distance and winding_number need a broad phase that finds what is near,
// at any distance: bvh, or all_pairs
#include <collide/bucket.cuh>
#include <collide/sinks/nearest.hpp>

int main() {
  collide::detector<collide::bucket> detector;
  detector.query(collide::point_view<float>(), collide::nearest());
}
