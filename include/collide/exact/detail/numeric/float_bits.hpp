/// \file
/// The bits of floating-point numbers: what is decided on them holds with -ffast-math too.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// How many of the highest bits of a number that is not 0 are 0.
COLLIDE_HD_INLINE int leading_zeros(std::uint64_t x) {
  return COLLIDE_ON_DEVICE(__clzll(static_cast<long long>(x)), __builtin_clzll(x));
}

/// The unsigned integer of the size of `T`.
template <class T>
using uint_for = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;

template <class T>
COLLIDE_HD_INLINE uint_for<T> to_bits(T x) {
  uint_for<T> u;
  std::memcpy(&u, &x, sizeof u);
  return u;
}

template <class T>
COLLIDE_HD_INLINE T from_bits(uint_for<T> u) {
  T x;
  std::memcpy(&x, &u, sizeof x);
  return x;
}

template <class T>
struct ieee_traits;
template <>
struct ieee_traits<float> {
  static constexpr std::uint32_t exponent_mask = 0x7f800000u, sign_mask = 0x80000000u;
  static constexpr int mantissa_bits = 23, bias = 127;
  static constexpr float unit_roundoff = 0x1p-24f;  ///< unit roundoff
  /// A sum at least this large is the same whether or not subnormal numbers are flushed to zero.
  static constexpr float min_sum_under_ftz = 0x1p-99f;
};
template <>
struct ieee_traits<double> {
  static constexpr std::uint64_t exponent_mask = 0x7ff0000000000000u, sign_mask = 0x8000000000000000u;
  static constexpr int mantissa_bits = 52, bias = 1023;
  static constexpr double unit_roundoff = 0x1p-53;
  static constexpr double min_sum_under_ftz = 0x1p-960;
};

/// `a` if `condition` holds, else `b`. On the host without a branch that a compiler could move the computation of `a`
/// or `b` into: loops in which it does so are not vectorised.
template <class T>
COLLIDE_HD_INLINE T select(bool condition, T a, T b) {
#if defined(__CUDA_ARCH__)
  return condition ? a : b;
#else
  auto const mask = static_cast<uint_for<T>>(-static_cast<uint_for<T>>(condition));
  return from_bits<T>((to_bits(a) & mask) | (to_bits(b) & ~mask));
#endif
}

/// x limited to 0 .. 1; NaN becomes 0.
template <class T>
COLLIDE_HD_INLINE T saturate(T x) {
  return select(x > T(0), select(x < T(1), x, T(1)), T(0));
}

/// Neither NaN nor infinite; decided on bits, because -ffinite-math-only deletes std::isfinite.
template <class T>
COLLIDE_HD_INLINE bool is_finite(T x) {
  // guard: finite
  return (to_bits(x) & ieee_traits<T>::exponent_mask) != ieee_traits<T>::exponent_mask;
}

/// The bits of the coordinate that is largest without its sign: they sort like the coordinates, NaN last.
template <class T>
COLLIDE_HD_INLINE uint_for<T> largest_bits(vec3<T> const& v) {
  constexpr uint_for<T> mask = ~ieee_traits<T>::sign_mask;
  return max(max(to_bits(v.x()) & mask, to_bits(v.y()) & mask), to_bits(v.z()) & mask);
}

template <class T>
COLLIDE_HD_INLINE bool is_finite(vec3<T> const& v) {
  return largest_bits(v) < ieee_traits<T>::exponent_mask;
}

template <class T>
COLLIDE_HD_INLINE bool is_finite(triangle<T> const& t) {
  // guard: finite-corner
  return max(max(largest_bits(t.a), largest_bits(t.b)), largest_bits(t.c)) < ieee_traits<T>::exponent_mask;
}

/// A radius that a point can be within: not NaN, not below zero (-0 is 0); decided on bits. +infinity passes.
template <class T>
COLLIDE_HD_INLINE bool is_valid_radius(T r) {
  auto const u = to_bits(r);
  // guard: valid-radius
  return u <= ieee_traits<T>::exponent_mask || u == ieee_traits<T>::sign_mask;
}

/// Positive infinity; decided on bits.
template <class T>
COLLIDE_HD_INLINE bool is_infinite(T r) {
  return to_bits(r) == ieee_traits<T>::exponent_mask;
}

/// Maps a float to an unsigned integer, preserving order (-infinity first, +infinity last).
template <class T>
COLLIDE_HD_INLINE uint_for<T> to_ordered_bits(T x) {
  auto const u = to_bits(x);
  return (u & ieee_traits<T>::sign_mask) != 0 ? ~u : (u | ieee_traits<T>::sign_mask);
}

template <class T>
COLLIDE_HD_INLINE T from_ordered_bits(uint_for<T> u) {
  return from_bits<T>((u & ieee_traits<T>::sign_mask) != 0 ? (u & ~ieee_traits<T>::sign_mask) : ~u);
}

/// The next number below a finite one; below 0, where subnormal numbers may be flushed, the normal one next to it.
template <class T>
COLLIDE_HD_INLINE T next_below(T x) {
  return x == T(0) ? -std::numeric_limits<T>::min() : from_ordered_bits<T>(to_ordered_bits(x) - 1);
}

/// The power of two 2^-e with 2^e <= |x| < 2^(e+1), kept normal; 2^(bias - 1) for zero and subnormal x.
template <class T>
COLLIDE_HD_INLINE T inverse_power_of_two(T x) {
  auto const e = static_cast<int>((to_bits(x) & ieee_traits<T>::exponent_mask) >> ieee_traits<T>::mantissa_bits);
  int const r = 2 * ieee_traits<T>::bias - e;  // biased exponent of 2^-(e - bias)
  return from_bits<T>(static_cast<uint_for<T>>(max(r, 1)) << ieee_traits<T>::mantissa_bits);
}

}  // namespace collide::detail
