// expect: collide: refit is for a broad phase that moves its tree along, bvh: with others build again
#include <collide/bucket.cuh>

int main() {
  collide::detector<collide::bucket> detector;
  detector.refit(collide::mesh_view<float>());
}
