/// \file
/// Spheres that are on the GPU already, in a thrust::device_vector, on a stream of one's own. Needs CUDA.

#include <cstdio>
#include <vector>

#include <thrust/device_vector.h>
#include <thrust/execution_policy.h>
#include <thrust/reduce.h>

#include <collide/bucket.cuh>

int main() {
  if (collide::cuda_device_count() == 0) {
    std::puts("no CUDA device");
    return 77;  // CTest: skipped
  }
  cudaStream_t stream;
  collide::cuda_check(cudaStreamCreate(&stream), "cudaStreamCreate");
  {
    std::vector<float> const square{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    std::vector<unsigned> const triangles{0, 1, 2, 0, 2, 3};
    std::vector<float> const points{0.9f, 0.1f, 0, 0.1f, 0.9f, 0, 0.5f, 0.5f, 0, 5, 5, 5};
    thrust::device_vector<float> vertices(square), centres(points);
    thrust::device_vector<unsigned> corners(triangles);
    thrust::device_vector<unsigned char> touched(points.size() / 3);

    collide::detector<collide::bucket, collide::karabassi<>, collide::cuda_shared> detector{
        collide::cuda_shared(stream)};
    detector.build(collide::indexed_mesh(thrust::raw_pointer_cast(vertices.data()), 4,
                                         thrust::raw_pointer_cast(corners.data()), 2));
    auto const spheres = collide::spheres_xyz(thrust::raw_pointer_cast(centres.data()), touched.size(), 0.2f);

    // The flags are set on the stream, and Thrust goes on with them there: the host waits for the sum alone.
    collide::any_hit flags(thrust::raw_pointer_cast(touched.data()));
    detector.query(spheres, flags);
    int const n = thrust::reduce(thrust::cuda::par.on(stream), touched.begin(), touched.end(), 0);
    std::printf("%d of %d spheres touch the mesh\n", n, static_cast<int>(touched.size()));
  }
  collide::cuda_check(cudaStreamDestroy(stream), "cudaStreamDestroy");
}
