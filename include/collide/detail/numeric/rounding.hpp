/// \file
/// Arithmetic that gives the same bits on host and device, whatever the compiler may contract or approximate.
///
/// On the device every product, quotient and root is an explicitly rounded intrinsic, so that neither -fmad nor
/// --use_fast_math changes it; sums of such products cannot be contracted either. On the host the target
/// collide::collide adds -ffp-contract=off.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <collide/geometry.hpp>

namespace collide::detail {

COLLIDE_HD_INLINE float mul(float a, float b) {
#if defined(__CUDA_ARCH__)
  return __fmul_rn(a, b);
#else
  return a * b;
#endif
}

COLLIDE_HD_INLINE double mul(double a, double b) {
#if defined(__CUDA_ARCH__)
  return __dmul_rn(a, b);
#else
  return a * b;
#endif
}

COLLIDE_HD_INLINE float div(float a, float b) {
#if defined(__CUDA_ARCH__)
  return __fdiv_rn(a, b);
#else
  return a / b;
#endif
}

COLLIDE_HD_INLINE double div(double a, double b) {
#if defined(__CUDA_ARCH__)
  return __ddiv_rn(a, b);
#else
  return a / b;
#endif
}

COLLIDE_HD_INLINE float root(float a) {
#if defined(__CUDA_ARCH__)
  return __fsqrt_rn(a);
#else
  return std::sqrt(a);
#endif
}

COLLIDE_HD_INLINE double root(double a) {
#if defined(__CUDA_ARCH__)
  return __dsqrt_rn(a);
#else
  return std::sqrt(a);
#endif
}

/// a * b + c: rounded once on the device, and on the host as the compiler likes.
COLLIDE_HD_INLINE float fused(float a, float b, float c) {
#if defined(__CUDA_ARCH__)
  return __fmaf_rn(a, b, c);
#else
  return a * b + c;
#endif
}

COLLIDE_HD_INLINE double fused(double a, double b, double c) {
#if defined(__CUDA_ARCH__)
  return __fma_rn(a, b, c);
#else
  return a * b + c;
#endif
}

/// The value as it was computed: a compiler that may reassociate sums (-ffast-math) cannot look through it.
template <class T>
COLLIDE_HD_INLINE T settled(T x) {
#if !defined(__CUDA_ARCH__) && (defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__))
  T volatile const kept = x;
  return kept;
#else
  return x;
#endif
}

/// Makes the device read all of `x` now: else a compiler puts off what is used later, behind a branch, and that waits
/// for the memory again.
template <class T>
COLLIDE_HD_INLINE void read_at_once([[maybe_unused]] T& x) {
#if defined(__CUDA_ARCH__)
  static_assert(sizeof(T) % sizeof(std::uint32_t) == 0, "collide: is kept in registers of 32 bits");
  std::uint32_t words[sizeof(T) / sizeof(std::uint32_t)];
  std::memcpy(words, static_cast<void const*>(&x), sizeof x);
  for (auto& word : words) asm volatile("" : "+r"(word));
  std::memcpy(static_cast<void*>(&x), words, sizeof x);
#endif
}

template <class T>
COLLIDE_HD_INLINE T dot(vec3<T> const& a, vec3<T> const& b) {
  return mul(a.x(), b.x()) + mul(a.y(), b.y()) + mul(a.z(), b.z());
}

template <class T>
COLLIDE_HD_INLINE T fused_dot(vec3<T> const& a, vec3<T> const& b) {
  return fused(a.x(), b.x(), fused(a.y(), b.y(), mul(a.z(), b.z())));
}

template <class T>
COLLIDE_HD_INLINE vec3<T> cross(vec3<T> const& a, vec3<T> const& b) {
  return {mul(a.y(), b.z()) - mul(a.z(), b.y()), mul(a.z(), b.x()) - mul(a.x(), b.z()),
          mul(a.x(), b.y()) - mul(a.y(), b.x())};
}

template <class T>
COLLIDE_HD_INLINE vec3<T> scaled(vec3<T> const& a, T s) {
  return {mul(a.x(), s), mul(a.y(), s), mul(a.z(), s)};
}

/// 1 / x to within two units in the last place, for x between 2^-126 and 2^126.
COLLIDE_HD_INLINE float quick_reciprocal(float x) {
#if defined(__CUDA_ARCH__)
  return __fdividef(1.0f, x);
#else
  return 1 / x;
#endif
}
COLLIDE_HD_INLINE double quick_reciprocal(double x) { return 1 / x; }

template <class T>
COLLIDE_HD_INLINE T smaller(T a, T b) {
  return b < a ? b : a;
}

template <class T>
COLLIDE_HD_INLINE T larger(T a, T b) {
  return a < b ? b : a;
}

template <class T>
COLLIDE_HD_INLINE vec3<T> smaller(vec3<T> const& a, vec3<T> const& b) {
  return {smaller(a.x(), b.x()), smaller(a.y(), b.y()), smaller(a.z(), b.z())};
}

template <class T>
COLLIDE_HD_INLINE vec3<T> larger(vec3<T> const& a, vec3<T> const& b) {
  return {larger(a.x(), b.x()), larger(a.y(), b.y()), larger(a.z(), b.z())};
}

template <class T>
COLLIDE_HD_INLINE T largest(vec3<T> const& a) {
  return larger(larger(a.x(), a.y()), a.z());
}

/// The unsigned integer of the size of `T`.
template <class T>
using bits_of = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;

template <class T>
COLLIDE_HD_INLINE bits_of<T> bits(T x) {
  bits_of<T> u;
  std::memcpy(&u, &x, sizeof u);
  return u;
}

template <class T>
COLLIDE_HD_INLINE T from_bits(bits_of<T> u) {
  T x;
  std::memcpy(&x, &u, sizeof x);
  return x;
}

template <class T>
struct format;
template <>
struct format<float> {
  static constexpr std::uint32_t exponent_mask = 0x7f800000u, sign_mask = 0x80000000u;
  static constexpr int mantissa_bits = 23, bias = 127;
  static constexpr float unit = 0x1p-24f;  ///< unit roundoff
  /// A sum at least this large is the same whether or not subnormal numbers are flushed to zero.
  static constexpr float unflushed = 0x1p-99f;
};
template <>
struct format<double> {
  static constexpr std::uint64_t exponent_mask = 0x7ff0000000000000u, sign_mask = 0x8000000000000000u;
  static constexpr int mantissa_bits = 52, bias = 1023;
  static constexpr double unit = 0x1p-53;
  static constexpr double unflushed = 0x1p-960;
};

/// `a` if `condition` holds, else `b`. On the host without a branch that a compiler could move the computation of `a`
/// or `b` into: loops in which it does so are not vectorised.
template <class T>
COLLIDE_HD_INLINE T select(bool condition, T a, T b) {
#if defined(__CUDA_ARCH__)
  return condition ? a : b;
#else
  auto const mask = static_cast<bits_of<T>>(-static_cast<bits_of<T>>(condition));
  return from_bits<T>((bits(a) & mask) | (bits(b) & ~mask));
#endif
}

/// Limited to 0 .. 1.
template <class T>
COLLIDE_HD_INLINE T clamped(T x) {
  return select(x > T(0), select(x < T(1), x, T(1)), T(0));
}

/// Neither NaN nor infinite; decided on bits, because -ffinite-math-only deletes std::isfinite.
template <class T>
COLLIDE_HD_INLINE bool finite(T x) {
  return (bits(x) & format<T>::exponent_mask) != format<T>::exponent_mask;
}

/// The bits of the coordinate that is largest without its sign: they sort like the coordinates, NaN last.
template <class T>
COLLIDE_HD_INLINE bits_of<T> largest_bits(vec3<T> const& v) {
  constexpr bits_of<T> mask = ~format<T>::sign_mask;
  return larger(larger(bits(v.x()) & mask, bits(v.y()) & mask), bits(v.z()) & mask);
}

template <class T>
COLLIDE_HD_INLINE bool finite(vec3<T> const& v) {
  return largest_bits(v) < format<T>::exponent_mask;
}

template <class T>
COLLIDE_HD_INLINE bool finite(triangle<T> const& t) {
  return larger(larger(largest_bits(t.a), largest_bits(t.b)), largest_bits(t.c)) < format<T>::exponent_mask;
}

/// A radius that a point can be within: not NaN, not below zero (-0 is 0); decided on bits. +infinity passes.
template <class T>
COLLIDE_HD_INLINE bool valid_radius(T r) {
  auto const u = bits(r);
  return u <= format<T>::exponent_mask || u == format<T>::sign_mask;
}

/// Positive infinity; decided on bits.
template <class T>
COLLIDE_HD_INLINE bool infinite(T r) {
  return bits(r) == format<T>::exponent_mask;
}

/// Maps floats to unsigned integers that sort alike (-infinity first, +infinity last).
template <class T>
COLLIDE_HD_INLINE bits_of<T> ordered(T x) {
  auto const u = bits(x);
  return (u & format<T>::sign_mask) != 0 ? ~u : (u | format<T>::sign_mask);
}

/// The inverse of `ordered`.
template <class T>
COLLIDE_HD_INLINE T from_ordered(bits_of<T> u) {
  return from_bits<T>((u & format<T>::sign_mask) != 0 ? (u & ~format<T>::sign_mask) : ~u);
}

/// The power of two 2^-e with 2^e <= |x| < 2^(e+1), kept normal; 2^(bias - 1) for zero and subnormal x.
template <class T>
COLLIDE_HD_INLINE T reciprocal_power(T x) {
  auto const e = static_cast<int>((bits(x) & format<T>::exponent_mask) >> format<T>::mantissa_bits);
  int const r = 2 * format<T>::bias - e;  // biased exponent of 2^-(e - bias)
  return from_bits<T>(static_cast<bits_of<T>>(larger(r, 1)) << format<T>::mantissa_bits);
}

}  // namespace collide::detail
