/// \file
/// Atomic operations on plain memory, alike on host and device.
#pragma once

#include <cstdint>

#include <collide/config.hpp>

namespace collide::detail {

/// Adds and returns the value before.
COLLIDE_HD_INLINE std::uint32_t fetch_add(std::uint32_t* target, std::uint32_t n) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(target, n);
#else
  return __atomic_fetch_add(target, n, __ATOMIC_RELAXED);
#endif
}

COLLIDE_HD_INLINE std::uint64_t fetch_add(std::uint64_t* target, std::uint64_t n) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(n));
#else
  return __atomic_fetch_add(target, n, __ATOMIC_RELAXED);
#endif
}

COLLIDE_HD_INLINE void fetch_min(std::uint32_t* target, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  atomicMin(target, value);
#else
  std::uint32_t seen = __atomic_load_n(target, __ATOMIC_RELAXED);
  while (value < seen && !__atomic_compare_exchange_n(target, &seen, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
#endif
}

COLLIDE_HD_INLINE void fetch_min(std::uint64_t* target, std::uint64_t value) {
#if defined(__CUDA_ARCH__)
  atomicMin(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
  std::uint64_t seen = __atomic_load_n(target, __ATOMIC_RELAXED);
  while (value < seen && !__atomic_compare_exchange_n(target, &seen, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
#endif
}

/// A store that other threads may make too.
template <class T>
COLLIDE_HD_INLINE void store_relaxed(T* target, T value) {
#if defined(__CUDA_ARCH__)
  *target = value;
#else
  __atomic_store_n(target, value, __ATOMIC_RELAXED);
#endif
}

}  // namespace collide::detail
