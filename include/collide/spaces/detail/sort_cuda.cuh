/// \file
/// Sorts pairs into canonical order, and numbers by keys, on an NVIDIA GPU. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error "collide/spaces/detail/sort_cuda.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <cstddef>
#include <cstdint>

#include <cub/device/device_merge_sort.cuh>
#include <cub/device/device_radix_sort.cuh>
#include <cuda_runtime.h>

#include <collide/core/contact.hpp>
#include <collide/core/memory.hpp>
#include <collide/spaces/cuda_memory.cuh>

namespace collide::detail {

/// The canonical order of pairs that are one number each, with the sphere in its lower half.
struct canonical_less {
  __device__ __forceinline__ bool operator()(std::uint64_t a, std::uint64_t b) const {
    return (a << 32 | a >> 32) < (b << 32 | b >> 32);
  }
};

/// The number of pairs up to which merging is faster than sorting by radix (docs/development/experiments.md).
inline constexpr std::size_t merge_sort_limit = std::size_t{1} << 18;

/// Bits that ids below `n` take; at least one.
inline int bits_for(std::size_t n) {
  int b = 1;
  while (b < 32 && (std::size_t{1} << b) < n) ++b;
  return b;
}

/// Temporary memory, in bytes, to sort up to `n` pairs by merging.
inline std::size_t merge_sort_bytes(cudaStream_t stream, std::size_t n) {
  std::size_t bytes = 0;
  std::uint64_t* const none = nullptr;
  cuda_check(cub::DeviceMergeSort::SortKeys(nullptr, bytes, none, n, canonical_less{}, stream),
             "cub::DeviceMergeSort::SortKeys");
  return bytes;
}
/// Temporary memory, in bytes, to sort `n` pairs by radix.
inline std::size_t radix_sort_bytes(cudaStream_t stream, std::size_t n) {
  std::size_t bytes = 0;
  std::uint64_t* const none = nullptr;
  cuda_check(cub::DeviceRadixSort::SortKeys(nullptr, bytes, none, none, n, 0, 64, stream),
             "cub::DeviceRadixSort::SortKeys");
  return bytes;
}

/// Takes the memory of `sort_pairs_on_device` for up to `capacity` pairs, whichever way they are sorted.
inline void reserve_sort_on_device(cudaStream_t stream, std::pmr::memory_resource* resource, std::size_t capacity,
                                   buffer<pair>& other, buffer<unsigned char>& scratch) {
  std::size_t const merge_bytes = merge_sort_bytes(stream, capacity < merge_sort_limit ? capacity : merge_sort_limit);
  if (capacity <= merge_sort_limit) {
    scratch.reserve(resource, merge_bytes);
    return;
  }
  std::size_t const radix_bytes = radix_sort_bytes(stream, capacity);
  scratch.reserve(resource, merge_bytes > radix_bytes ? merge_bytes : radix_bytes);
  other.reserve(resource, capacity);
}

/// Sorts pairs into canonical order: not very many by merging; more by radix, by triangle, then (stably) by sphere,
/// only the bits that ids below `spheres` and `triangles` have. Takes temporary memory for `capacity` pairs, at least
/// `n`.
inline void sort_pairs_on_device(cudaStream_t stream, std::pmr::memory_resource* resource, pair* pairs, std::size_t n,
                                 std::size_t capacity, std::size_t spheres, std::size_t triangles, buffer<pair>& other,
                                 buffer<unsigned char>& scratch) {
  static_assert(sizeof(pair) == sizeof(std::uint64_t), "a pair is one 64-bit key");
  if (n < 2) return;
  auto* const keys = reinterpret_cast<std::uint64_t*>(pairs);
  // where there is room for many, the memory for both ways is taken the first time
  bool const uses_radix = n > merge_sort_limit;
  if (capacity > merge_sort_limit && other.capacity() < capacity) {
    reserve_sort_on_device(stream, resource, capacity, other, scratch);
  }
  std::size_t const limit = capacity < merge_sort_limit ? capacity : merge_sort_limit;
  std::size_t merge_bytes = uses_radix ? 0 : merge_sort_bytes(stream, limit),
              radix_bytes = uses_radix ? radix_sort_bytes(stream, capacity) : 0;
  void* const temporary = scratch.reserve(resource, uses_radix ? radix_bytes : merge_bytes);
  auto* const sorted = reinterpret_cast<std::uint64_t*>(other.data());
  if (!uses_radix) {
    cuda_check(cub::DeviceMergeSort::SortKeys(temporary, merge_bytes, keys, n, canonical_less{}, stream),
               "cub::DeviceMergeSort::SortKeys");
    return;
  }
  cuda_check(
      cub::DeviceRadixSort::SortKeys(temporary, radix_bytes, keys, sorted, n, 32, 32 + bits_for(triangles), stream),
      "cub::DeviceRadixSort::SortKeys");
  cuda_check(cub::DeviceRadixSort::SortKeys(temporary, radix_bytes, sorted, keys, n, 0, bits_for(spheres), stream),
             "cub::DeviceRadixSort::SortKeys");
}

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
