/// \file
/// Atomic operations on plain memory, alike on host and device.
#pragma once

#include <cstdint>

#include <collide/core/config.hpp>

namespace collide::detail {

/// True while this thread is the only one that works for a space. A locked instruction costs several times as much as a
/// plain one.
inline thread_local bool single_threaded = false;

class single_threaded_scope {
 public:
  explicit single_threaded_scope(bool alone) { single_threaded = alone; }
  single_threaded_scope(single_threaded_scope const&) = delete;
  single_threaded_scope& operator=(single_threaded_scope const&) = delete;
  ~single_threaded_scope() { single_threaded = before_; }

 private:
  bool before_ = single_threaded;
};

#if defined(__CUDA_ARCH__)
/// The type that CUDA's atomic functions take for an unsigned integer.
__device__ __forceinline__ unsigned int* as_cuda(std::uint32_t* p) { return p; }
__device__ __forceinline__ unsigned long long* as_cuda(std::uint64_t* p) {
  return reinterpret_cast<unsigned long long*>(p);
}
#endif

/// Adds and returns the value before. `U` is std::uint32_t or std::uint64_t.
template <class U>
COLLIDE_HD_INLINE U fetch_add(U* target, U n) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(as_cuda(target), n);
#else
  if (!single_threaded) return __atomic_fetch_add(target, n, __ATOMIC_RELAXED);
  U const before = *target;
  *target += n;
  return before;
#endif
}

/// Adds. In whatever order threads do so: the sum of whole numbers is exact.
COLLIDE_HD_INLINE void fetch_add(double* target, double n) {
#if defined(__CUDA_ARCH__)
  atomicAdd(target, n);
#else
  double seen = *target, sum;
  do {
    sum = seen + n;
  } while (!__atomic_compare_exchange(target, &seen, &sum, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED));
#endif
}

/// Sets the bits of `mask`.
COLLIDE_HD_INLINE void fetch_or(std::uint32_t* target, std::uint32_t mask) {
  COLLIDE_ON_DEVICE(atomicOr(target, mask), __atomic_fetch_or(target, mask, __ATOMIC_RELAXED));
}

/// Makes `*target` the smaller of itself and `value`.
template <class U>
COLLIDE_HD_INLINE void fetch_min(U* target, U value) {
#if defined(__CUDA_ARCH__)
  atomicMin(as_cuda(target), value);
#else
  U seen = __atomic_load_n(target, __ATOMIC_RELAXED);
  while (value < seen && !__atomic_compare_exchange_n(target, &seen, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
#endif
}

/// Makes `*target` the larger of itself and `value`.
template <class U>
COLLIDE_HD_INLINE void fetch_max(U* target, U value) {
#if defined(__CUDA_ARCH__)
  atomicMax(as_cuda(target), value);
#else
  U seen = __atomic_load_n(target, __ATOMIC_RELAXED);
  while (value > seen && !__atomic_compare_exchange_n(target, &seen, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
#endif
}

/// Orders memory: who sees what this thread writes, or adds atomically, afterwards, sees what it wrote before.
COLLIDE_HD_INLINE void thread_fence() { COLLIDE_ON_DEVICE(__threadfence(), __atomic_thread_fence(__ATOMIC_ACQ_REL)); }

/// A load of what other threads may change meanwhile.
template <class T>
COLLIDE_HD_INLINE T load_relaxed(T const* from) {
  return COLLIDE_ON_DEVICE(*from, __atomic_load_n(from, __ATOMIC_RELAXED));
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

/// Adds 1 to up to `N` counters a thread, which are known by their numbers. Threads of a warp that meet at a counter,
/// as those of neighbouring triangles do in a cell, add together: a counter takes its time for each that asks it.
template <unsigned N>
class aggregated_count {
 public:
  /// The counters `number_of(k)` whose bit k in the mask is set.
  template <class NumberOf>
  COLLIDE_HD_INLINE void match(NumberOf const& number_of, std::uint32_t mask) {
    for (std::uint32_t k = 0; k < N; ++k) {
      bool const counts = (mask >> k & 1) != 0;
      numbers_[k] = number_of(k);
#if defined(__CUDA_ARCH__)
      unsigned const with = __match_any_sync(__activemask(), counts ? numbers_[k] : none);
      with_[k] = counts ? with : 0;
#else
      with_[k] = counts ? 1 : 0;
#endif
    }
  }

  /// `counter(number)` is the address of a counter.
  template <class Counter>
  COLLIDE_HD_INLINE void add(Counter const& counter) {
    for (std::uint32_t k = 0; k < N; ++k) {
      std::uint32_t const n = count_of_bits(with_[k]), earlier = count_of_bits(with_[k] & lanes_before());
      before_[k] = n != 0 && earlier == 0 ? fetch_add(counter(numbers_[k]), n) : 0;
    }
  }

  /// The value of counter `k` before this thread's 1 was added.
  COLLIDE_HD_INLINE std::uint32_t before(std::uint32_t k) const {
#if defined(__CUDA_ARCH__)
    if (with_[k] == 0) return 0;
    return __shfl_sync(with_[k], before_[k], __ffs(static_cast<int>(with_[k])) - 1) +
           count_of_bits(with_[k] & lanes_before());
#else
    return before_[k];
#endif
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};  ///< no counter has this number

  static COLLIDE_HD_INLINE std::uint32_t count_of_bits(std::uint32_t bits) {
    return COLLIDE_ON_DEVICE(static_cast<std::uint32_t>(__popc(bits)), bits);  // 0 or 1: a thread is alone
  }
  static COLLIDE_HD_INLINE std::uint32_t lanes_before() { return COLLIDE_ON_DEVICE((1u << threadIdx.x % 32) - 1, 0); }

  std::uint32_t numbers_[N], with_[N], before_[N];
};

}  // namespace collide::detail
