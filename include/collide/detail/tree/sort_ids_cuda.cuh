/// \file
/// Sorts numbers by keys on an NVIDIA GPU. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error "collide/detail/tree/sort_ids_cuda.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <cstddef>
#include <cstdint>

#include <cub/device/device_radix_sort.cuh>
#include <cuda_runtime.h>

#include <collide/cuda_memory.cuh>
#include <collide/geometry.hpp>
#include <collide/memory.hpp>

namespace collide::detail {

/// Sorts `n` numbers by the lowest `bits` bits of their keys; those of equal keys keep their order. Results are in the
/// `sorted` arrays.
inline void sort_ids_on_device(cudaStream_t stream, std::pmr::memory_resource* resource, std::uint64_t const* keys,
                               std::uint64_t* sorted_keys, id const* ids, id* sorted_ids, std::size_t n, int bits,
                               buffer<unsigned char>& scratch) {
  std::size_t bytes = 0;
  auto const sort = [&](void* temporary) {
    cuda_check(
        cub::DeviceRadixSort::SortPairs(temporary, bytes, keys, sorted_keys, ids, sorted_ids, n, 0, bits, stream),
        "cub::DeviceRadixSort::SortPairs");
  };
  sort(nullptr);
  sort(scratch.reserve(resource, bytes));
}

}  // namespace collide::detail
