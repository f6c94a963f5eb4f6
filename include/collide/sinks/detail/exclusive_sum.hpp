/// \file
/// Makes of each value the sum of those before it, in memory of any space.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/core/error.hpp>
#include <collide/core/memory.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#if defined(__CUDACC__)
#include <cub/device/device_scan.cuh>

#include <collide/spaces/cuda_memory.cuh>
#endif

namespace collide::detail {

/// Temporary memory, in bytes, of `exclusive_sum` of n values on the stream of a device; 0 on the host.
template <class Space>
std::size_t exclusive_sum_bytes([[maybe_unused]] Space const& space, [[maybe_unused]] std::size_t n) {
  std::size_t bytes = 0;
#if defined(__CUDACC__)
  if constexpr (!Space::host_accessible) {
    std::uint64_t* const none = nullptr;
    cuda_check(cub::DeviceScan::ExclusiveSum(nullptr, bytes, none, none, n, space.stream()),
               "cub::DeviceScan::ExclusiveSum");
  }
#endif
  return bytes;
}

/// Makes of each of n values the sum of those before it. A space whose memory the host cannot access has a member
/// `stream()`, and needs nvcc: throws `error` without.
template <class Space>
void exclusive_sum(Space const& space, std::uint64_t* values, std::size_t n,
                   [[maybe_unused]] buffer<unsigned char>& temporary) {
  if constexpr (Space::host_accessible) {
    exclusive_scan(space, values, n);
  } else {
#if defined(__CUDACC__)
    std::size_t bytes = exclusive_sum_bytes(space, n);
    void* const memory = temporary.reserve(space.resource(), bytes);
    cuda_check(cub::DeviceScan::ExclusiveSum(memory, bytes, values, values, n, space.stream()),
               "cub::DeviceScan::ExclusiveSum");
#else
    throw error("collide: csr: offsets in memory of a device are summed where nvcc compiles the program");
#endif
  }
}

}  // namespace collide::detail
