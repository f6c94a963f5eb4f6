/// \file
/// Sorts numbers by keys on an NVIDIA GPU. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error \
    "collide/broad/detail/tree/sort_ids_cuda.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <cstddef>
#include <cstdint>

#include <cub/device/device_radix_sort.cuh>
#include <cuda_runtime.h>

#include <collide/core/geometry.hpp>
#include <collide/core/memory.hpp>
#include <collide/spaces/cuda_memory.cuh>

namespace collide::detail {

/// How many bytes of scratch it takes to sort `n` numbers.
inline std::size_t bytes_to_sort_on_device(std::size_t n) {
  std::size_t bytes = 0;
  std::uint64_t* const keys = nullptr;
  id* const ids = nullptr;
  cuda_check(cub::DeviceRadixSort::SortPairs(nullptr, bytes, keys, keys, ids, ids, n),
             "cub::DeviceRadixSort::SortPairs");
  return bytes;
}

/// Sorts `n` numbers by the lowest `bits` bits of their keys; those of equal keys keep their order. Results are in the
/// `sorted` arrays.
inline void sort_ids_on_device(cudaStream_t stream, std::uint64_t const* keys, std::uint64_t* sorted_keys,
                               id const* ids, id* sorted_ids, std::size_t n, int bits, unsigned char* scratch) {
  std::size_t bytes = bytes_to_sort_on_device(n);
  cuda_check(cub::DeviceRadixSort::SortPairs(scratch, bytes, keys, sorted_keys, ids, sorted_ids, n, 0, bits, stream),
             "cub::DeviceRadixSort::SortPairs");
}

}  // namespace collide::detail
