// expect: collide: a __device__ lambda is for the CUDA spaces: on the host visit takes any other
#include <collide/bucket.cuh>

void query(collide::detector<collide::bucket>& detector, unsigned* count) {
  detector.query(collide::sphere_view<float>(),
                 collide::visit([count] __device__(auto const&) { atomicAdd(count, 1u); }));
}
