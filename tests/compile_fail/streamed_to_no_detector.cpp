// expect: collide: what spheres are streamed to is a detector, such as detector<bucket>
#include <collide/bucket.cuh>
#include <collide/detectors/streamed.cuh>

int main() {
  collide::bucket bucket;
  collide::streamed streamed(bucket);
}
