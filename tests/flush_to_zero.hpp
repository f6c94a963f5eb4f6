/// \file
/// A processor that takes subnormal numbers for zero, on x86 and on 64-bit Arm.
#pragma once

#if defined(__SSE__)
#include <xmmintrin.h>
#elif defined(__aarch64__)
#include <cstdint>
#else
#error "How does this processor flush subnormal numbers to zero?"
#endif

namespace tests {

/// While it lives, this thread's arithmetic takes subnormal numbers for zero, and makes none.
class flush_to_zero {
 public:
  flush_to_zero() : before_{mode()} { set(before_ | bits); }
  ~flush_to_zero() { set(before_); }
  flush_to_zero(flush_to_zero const&) = delete;
  flush_to_zero& operator=(flush_to_zero const&) = delete;

 private:
#if defined(__SSE__)
  using word = unsigned;
  static constexpr word bits = 0x8040;  // FTZ and DAZ of MXCSR
  static word mode() { return _mm_getcsr(); }
  static void set(word to) { _mm_setcsr(to); }
#else
  using word = std::uint64_t;
  static constexpr word bits = 1u << 24;  // FZ of FPCR
  static word mode() {
    word now = 0;
    asm volatile("mrs %0, fpcr" : "=r"(now) : : "memory");
    return now;
  }
  static void set(word to) { asm volatile("msr fpcr, %0" : : "r"(to) : "memory"); }
#endif
  word before_;
};

}  // namespace tests
