/// \file
/// Counters that many threads add 1 to at the same time, asked once by all threads of a warp that want the same one.
#pragma once

#include <cstdint>

#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

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
