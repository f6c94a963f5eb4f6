/// \file
/// Arithmetic that gives the same bits on host and device, whatever the compiler may contract or approximate.
///
/// On the device every product, quotient and root is an explicitly rounded intrinsic, so that neither -fmad nor
/// --use_fast_math changes it; sums of such products cannot be contracted either. On the host the target
/// collide::collide adds -ffp-contract=off; collide::cuda adds -fmad=false, for what is plain arithmetic.
#pragma once

#include <cmath>

#include <collide/core/geometry.hpp>

namespace collide::detail {

COLLIDE_HD_INLINE float mul_rn(float a, float b) { return COLLIDE_ON_DEVICE(__fmul_rn(a, b), a * b); }

COLLIDE_HD_INLINE double mul_rn(double a, double b) { return COLLIDE_ON_DEVICE(__dmul_rn(a, b), a * b); }

COLLIDE_HD_INLINE float div_rn(float a, float b) { return COLLIDE_ON_DEVICE(__fdiv_rn(a, b), a / b); }

COLLIDE_HD_INLINE double div_rn(double a, double b) { return COLLIDE_ON_DEVICE(__ddiv_rn(a, b), a / b); }

/// A quotient to within a few units in the last place, of numbers in the middle of the range; faster on a device.
COLLIDE_HD_INLINE float div_approximately(float a, float b) { return COLLIDE_ON_DEVICE(__fdividef(a, b), a / b); }
COLLIDE_HD_INLINE double div_approximately(double a, double b) { return a / b; }

COLLIDE_HD_INLINE float sqrt_rn(float a) { return COLLIDE_ON_DEVICE(__fsqrt_rn(a), std::sqrt(a)); }

COLLIDE_HD_INLINE double sqrt_rn(double a) { return COLLIDE_ON_DEVICE(__dsqrt_rn(a), std::sqrt(a)); }

/// a * b + c: fused on the device; on the host the compiler chooses.
COLLIDE_HD_INLINE float mul_add(float a, float b, float c) { return COLLIDE_ON_DEVICE(__fmaf_rn(a, b, c), a * b + c); }

COLLIDE_HD_INLINE double mul_add(double a, double b, double c) {
  return COLLIDE_ON_DEVICE(__fma_rn(a, b, c), a * b + c);
}

/// a * b + c, rounded once everywhere.
COLLIDE_HD_INLINE float fma_rn(float a, float b, float c) {
  return COLLIDE_ON_DEVICE(__fmaf_rn(a, b, c), std::fma(a, b, c));
}

COLLIDE_HD_INLINE double fma_rn(double a, double b, double c) {
  return COLLIDE_ON_DEVICE(__fma_rn(a, b, c), std::fma(a, b, c));
}

/// The value as it was computed: a compiler that may reassociate sums (-ffast-math) cannot look through it.
template <class T>
COLLIDE_HD_INLINE T opaque_value(T x) {
#if !defined(__CUDA_ARCH__) && (defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__))
  T volatile const kept = x;
  return kept;
#else
  return x;
#endif
}

/// A vector of doubles, rounded to another scalar. g++ 12 leaves out roundings to float and back to double where its
/// SLP vectoriser pairs them: it cannot look through this.
template <class S>
COLLIDE_HD_INLINE vec3<S> rounded_to(vec3<double> const& x) {
  S r[3];
  COLLIDE_UNROLL
  for (int k = 0; k < 3; ++k) {
    r[k] = static_cast<S>(x[k]);
#if !defined(__CUDA_ARCH__) && defined(__GNUC__) && !defined(__clang__)
    if (sizeof(S) != sizeof(double)) __asm__("" : "+m"(r[k]));
#endif
  }
  return {r[0], r[1], r[2]};
}

template <class T>
COLLIDE_HD_INLINE T dot(vec3<T> const& a, vec3<T> const& b) {
  return mul_rn(a.x(), b.x()) + mul_rn(a.y(), b.y()) + mul_rn(a.z(), b.z());
}

template <class T>
COLLIDE_HD_INLINE T length_of(vec3<T> const& a) {
  return sqrt_rn(dot(a, a));
}
template <class T>
COLLIDE_HD_INLINE T dot_mul_add(vec3<T> const& a, vec3<T> const& b) {
  return mul_add(a.x(), b.x(), mul_add(a.y(), b.y(), mul_rn(a.z(), b.z())));
}

template <class T>
COLLIDE_HD_INLINE vec3<T> cross(vec3<T> const& a, vec3<T> const& b) {
  return {mul_rn(a.y(), b.z()) - mul_rn(a.z(), b.y()), mul_rn(a.z(), b.x()) - mul_rn(a.x(), b.z()),
          mul_rn(a.x(), b.y()) - mul_rn(a.y(), b.x())};
}

template <class T>
COLLIDE_HD_INLINE vec3<T> scaled(vec3<T> const& a, T s) {
  return {mul_rn(a.x(), s), mul_rn(a.y(), s), mul_rn(a.z(), s)};
}

/// 1 / x to within two units in the last place, for x between 2^-126 and 2^126.
COLLIDE_HD_INLINE float approx_reciprocal(float x) { return COLLIDE_ON_DEVICE(__fdividef(1.0f, x), 1 / x); }
COLLIDE_HD_INLINE double approx_reciprocal(double x) { return 1 / x; }

template <class T>
COLLIDE_HD_INLINE T min(T a, T b) {
  return b < a ? b : a;
}

template <class T>
COLLIDE_HD_INLINE T max(T a, T b) {
  return a < b ? b : a;
}

template <class T>
COLLIDE_HD_INLINE vec3<T> min(vec3<T> const& a, vec3<T> const& b) {
  return {min(a.x(), b.x()), min(a.y(), b.y()), min(a.z(), b.z())};
}

template <class T>
COLLIDE_HD_INLINE vec3<T> max(vec3<T> const& a, vec3<T> const& b) {
  return {max(a.x(), b.x()), max(a.y(), b.y()), max(a.z(), b.z())};
}

template <class T>
COLLIDE_HD_INLINE T max_component(vec3<T> const& a) {
  return max(max(a.x(), a.y()), a.z());
}

/// A vector in another scalar, rounded where that is narrower.
template <class T, class S>
COLLIDE_HD_INLINE vec3<T> cast_to(vec3<S> const& a) {
  return {static_cast<T>(a.x()), static_cast<T>(a.y()), static_cast<T>(a.z())};
}

/// The absolute values of the coordinates.
template <class T>
COLLIDE_HD_INLINE vec3<T> absolute(vec3<T> const& a) {
  return {std::abs(a.x()), std::abs(a.y()), std::abs(a.z())};
}

}  // namespace collide::detail
