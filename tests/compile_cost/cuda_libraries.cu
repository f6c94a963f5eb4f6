// The unit of scripts/compile-cost for nvcc: the libraries that a program for a GPU includes anyway, one kernel of
// each.
#include <Eigen/Core>
#include <cub/device/device_radix_sort.cuh>
#include <thrust/device_vector.h>

__global__ void add(Eigen::Vector3f* sums, Eigen::Vector3f const* terms) { sums[threadIdx.x] += terms[threadIdx.x]; }

int main() {
  thrust::device_vector<unsigned> keys(1000), sorted(1000);
  thrust::device_vector<Eigen::Vector3f> sums(32), terms(32);
  add<<<1, 32>>>(thrust::raw_pointer_cast(sums.data()), thrust::raw_pointer_cast(terms.data()));
  std::size_t bytes = 0;
  unsigned const* from = thrust::raw_pointer_cast(keys.data());
  unsigned* to = thrust::raw_pointer_cast(sorted.data());
  cub::DeviceRadixSort::SortKeys(nullptr, bytes, from, to, 1000);
  thrust::device_vector<char> memory(bytes);
  cub::DeviceRadixSort::SortKeys(thrust::raw_pointer_cast(memory.data()), bytes, from, to, 1000);
}
