/// \file
/// Sorts pairs into canonical order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>

#include <collide/core/contact.hpp>
#include <collide/core/error.hpp>
#include <collide/core/memory.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#if defined(__CUDACC__)
#include <collide/spaces/detail/sort_cuda.cuh>
#endif

namespace collide::detail {

struct sort_memory {
  buffer<pair> pairs;
  buffer<unsigned char> bytes;
};

/// Takes the memory of `sort_pairs` for up to `capacity` pairs.
template <class Space>
void reserve_sort_memory(Space const& space, std::size_t capacity, sort_memory& memory) {
  if constexpr (Space::host_accessible) {
    memory.pairs.reserve(space.resource(), capacity);
  } else {
#if defined(__CUDACC__)
    reserve_sort_on_device(space.stream(), space.resource(), capacity, memory.pairs, memory.bytes);
#endif
  }
}

/// Sorts n pairs, of which there may be `capacity` another time, in memory that the host can access: into parts by the
/// leading bits of the sphere, then each part.
template <class Space>
void sort_pairs_on_host(Space const& space, pair* pairs, std::size_t n, std::size_t capacity, std::size_t spheres,
                        sort_memory& memory) {
  constexpr std::size_t parts = 2048;
  pair* const copy = memory.pairs.reserve(space.resource(), capacity);
  if (n < parts) {
    std::sort(pairs, pairs + n);
    return;
  }
  int shift = 0;
  while ((spheres - 1) >> shift >= parts) ++shift;
  std::size_t begin[parts + 2] = {};  // of part p at p + 1, while the pairs are brought there; then at p
  for (std::size_t i = 0; i < n; ++i) ++begin[(pairs[i].sphere >> shift) + 2];
  std::partial_sum(begin, begin + parts + 2, begin);
  for (std::size_t i = 0; i < n; ++i) copy[begin[(pairs[i].sphere >> shift) + 1]++] = pairs[i];
  for_each_block(space, parts, [&](std::size_t p) {
    std::sort(copy + begin[p], copy + begin[p + 1]);
    std::copy(copy + begin[p], copy + begin[p + 1], pairs + begin[p]);
  });
}

/// Sorts n pairs of `spheres` spheres and `triangles` triangles. Takes temporary memory for `capacity` pairs, at least
/// n. A space whose memory the host cannot access has a member `stream()`, and needs nvcc: throws `error` without.
template <class Space>
void sort_pairs(Space const& space, pair* pairs, std::size_t n, std::size_t capacity, std::size_t spheres,
                [[maybe_unused]] std::size_t triangles, sort_memory& memory) {
  if constexpr (Space::host_accessible) {
    sort_pairs_on_host(space, pairs, n, capacity, spheres, memory);
  } else {
#if defined(__CUDACC__)
    sort_pairs_on_device(space.stream(), space.resource(), pairs, n, capacity, spheres, triangles, memory.pairs,
                         memory.bytes);
#else
    throw error("collide: the canonical order: pairs in memory of a device are sorted where nvcc compiles the program");
#endif
  }
}

}  // namespace collide::detail
