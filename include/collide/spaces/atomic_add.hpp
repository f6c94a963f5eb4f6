/// \file
/// Sums that many threads add to, for functions that `visit` calls.
#pragma once

#include <cstdint>
#include <type_traits>

#include <collide/spaces/detail/atomic.hpp>

namespace collide {

/// Adds `value` to `*target` and returns what was there before, without losing what other threads add meanwhile: on the
/// host to host memory, on the device to device memory. `T` is float, double, or an integer of 32 or 64 bits. Sums of
/// integers do not depend on the order; sums of floats do, in their last bits. O(1).
template <class T>
COLLIDE_HD_INLINE T atomic_add(T* target, std::common_type_t<T> value) {
  static_assert(std::is_same<T, float>::value || std::is_same<T, double>::value ||
                    (std::is_integral<T>::value && (sizeof(T) == 4 || sizeof(T) == 8)),
                "collide: atomic_add adds to float, double, or an integer of 32 or 64 bits");
#if defined(__CUDA_ARCH__)
  if constexpr (std::is_integral<T>::value) {
    using word = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    return static_cast<T>(atomicAdd(detail::as_cuda(reinterpret_cast<word*>(target)), static_cast<word>(value)));
  } else {
    return atomicAdd(target, value);
  }
#else
  if constexpr (std::is_integral<T>::value) {
    return __atomic_fetch_add(target, value, __ATOMIC_RELAXED);
  } else {
    T seen;
    __atomic_load(target, &seen, __ATOMIC_RELAXED);
    T sum = seen + value;
    while (!__atomic_compare_exchange(target, &seen, &sum, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
      sum = seen + value;
    return seen;
  }
#endif
}

}  // namespace collide
