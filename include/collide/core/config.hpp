/// \file
/// Markers of functions and loops for host and device: the only macros of the library, except for those of version.hpp,
/// compiled.hpp, core/detail/detected.hpp and simulation/detail/step/compiled_search.hpp.
#pragma once

#include <collide/core/version.hpp>

#if defined(__CUDACC__)
/// Marks a function that runs on the host and on the device.
#define COLLIDE_HD __host__ __device__
/// Marks a function that runs on the host and on the device and must be inlined where it is called.
#define COLLIDE_HD_INLINE __host__ __device__ __forceinline__
/// Marks a function that runs on the host and on the device and must not be inlined: it is called rarely.
#define COLLIDE_HD_NOINLINE __host__ __device__ __noinline__
#else
#define COLLIDE_HD
// What a sanitizer adds is too much to be inlined. Tests define COLLIDE_PLAIN_INLINE: they compile in two thirds of the
// time.
#if defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && !defined(COLLIDE_PLAIN_INLINE)
#define COLLIDE_HD_INLINE __attribute__((always_inline)) inline
#else
#define COLLIDE_HD_INLINE inline
#endif
#if defined(__GNUC__)
#define COLLIDE_HD_NOINLINE __attribute__((noinline))
#else
#define COLLIDE_HD_NOINLINE
#endif
#endif

#if defined(__CUDA_ARCH__)
/// The first of two expressions in device code, the second on the host.
#define COLLIDE_ON_DEVICE(device, host) device
#else
/// The first of two expressions in device code, the second on the host.
#define COLLIDE_ON_DEVICE(device, host) host
#endif

/// Marks a function that is called rarely: small on the host, and inlined on the device, where its loops become
/// registers.
#define COLLIDE_HD_RARE COLLIDE_ON_DEVICE(COLLIDE_HD_INLINE, COLLIDE_HD_NOINLINE inline)
/// Marks a template that a program for the host may link instead of compiling it (compiled.hpp): it is not inline
/// there.
#define COLLIDE_HD_LINKED COLLIDE_ON_DEVICE(COLLIDE_HD_INLINE, COLLIDE_HD)

#if defined(__GNUC__) && !defined(__CUDACC__)
/// Marks a function that is called once in a while: small, and quick to compile.
#define COLLIDE_COLD __attribute__((cold))
#else
/// Marks a function that is called once in a while: small, and quick to compile.
#define COLLIDE_COLD
#endif

#if defined(__GNUC__) && !defined(__CUDACC__) && !defined(__SANITIZE_ADDRESS__)
/// Marks a function or a lambda that a step or a query calls for each candidate: the host inlines it at every level of
/// optimisation, a device's compiler as it sees fit.
#define COLLIDE_HOT __attribute__((always_inline))
#else
/// Marks a function or a lambda that a step or a query calls for each candidate.
#define COLLIDE_HOT
#endif

#if defined(__CUDACC__) || !defined(__GNUC__)
/// Before a loop over a few items.
#define COLLIDE_UNROLL
#elif defined(__clang__)
/// Before a loop over a few items: the host's compiler unrolls it with -O2 as with -O3.
#define COLLIDE_UNROLL _Pragma("unroll")
#else
/// Before a loop over a few items: the host's compiler unrolls it with -O2 as with -O3.
#define COLLIDE_UNROLL _Pragma("GCC unroll 16")
#endif

#if defined(__GNUC__) && !defined(__clang__) && !defined(__CUDACC__) && defined(__OPTIMIZE__) && \
    !defined(__OPTIMIZE_SIZE__) && !defined(COLLIDE_PLAIN_INLINE)
/// Marks a function with the loops of a kernel, which g++ compiles with -O2 as with -O3; clang++ does nearly so by
/// itself.
#define COLLIDE_AS_O3 __attribute__((optimize("O3")))
#else
/// Marks a function with the loops of a kernel.
#define COLLIDE_AS_O3
#endif

#if defined(__CUDA_ARCH__)
/// Before a loop that the device does not unroll.
#define COLLIDE_NO_UNROLL _Pragma("unroll 1")
#else
/// Before a loop that the device does not unroll.
#define COLLIDE_NO_UNROLL
#endif
