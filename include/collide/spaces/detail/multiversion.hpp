/// \file
/// Loops for the widest vector unit of the processor that runs them.
#pragma once

#include <collide/core/config.hpp>

namespace collide::detail {

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__AVX2__) && !defined(__CUDA_ARCH__)

template <class F>
COLLIDE_AS_O3 __attribute__((target("avx2"), flatten, noinline)) void run_with_avx2(F const& f) {
  f();
}

/// Calls f(), in which a loop over plain arrays had better be vectorised. On x86 it is compiled twice, and a processor
/// with AVX2 runs the version that does 8 floats at a time. That version contains all that f() calls, except for
/// functions that are not inlined: what is not a tight loop had better be one of those. Elsewhere, or compiled with
/// -march, it is just a call. The results are the same bits: no product is fused with a sum.
template <class F>
void multiversioned(F const& f) {
  __builtin_cpu_supports("avx2") ? run_with_avx2(f) : f();
}

#else

template <class F>
COLLIDE_HD_INLINE void multiversioned(F const& f) {
  f();
}

#endif

}  // namespace collide::detail
