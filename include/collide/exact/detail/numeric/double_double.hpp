/// \file
/// Numbers of twice the digits of a double, each the sum of two: operations have an error of about 2^-104 (T. J.
/// Dekker, "A floating-point technique for extending the available precision", Numerische Mathematik 18, 1971).
///
/// Same bits on host and device, with a fused product and sum or without. Nothing here may over- or underflow: numbers
/// are scaled first.
#pragma once

#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// The number high + low, where `low` is at most half a unit in the last place of `high`.
struct double_double {
  double high, low;
};

/// a + b without error.
COLLIDE_HD_INLINE double_double exact_sum_of(double a, double b) {
  double const sum = opaque_value(a + b), of_b = opaque_value(sum - a), of_a = opaque_value(sum - of_b);
  double const lost_of_a = opaque_value(a - of_a), lost_of_b = opaque_value(b - of_b);
  return {sum, lost_of_a + lost_of_b};
}

/// a + b without error, where |a| >= |b| or a is 0.
COLLIDE_HD_INLINE double_double exact_sum_of_ordered(double a, double b) {
  double const sum = opaque_value(a + b), of_b = opaque_value(sum - a);
  return {sum, b - of_b};
}

/// The upper half of the digits; what is left of x has 26 bits too.
COLLIDE_HD_INLINE double upper_digits(double x) {
  double const shifted = opaque_value(mul_rn(x, 0x1p27 + 1)), rest = opaque_value(shifted - x);
  return opaque_value(shifted - rest);
}

/// a * b without error.
COLLIDE_HD_INLINE double_double exact_product_of(double a, double b) {
  double const product = opaque_value(mul_rn(a, b));
#if defined(__CUDA_ARCH__) || defined(__FP_FAST_FMA) || defined(__FMA__)
  return {product, fma_rn(a, b, -product)};
#else
  double const a1 = upper_digits(a), b1 = upper_digits(b), a2 = opaque_value(a - a1), b2 = opaque_value(b - b1);
  double const first = opaque_value(mul_rn(a1, b1) - product), second = opaque_value(first + mul_rn(a1, b2));
  double const third = opaque_value(second + mul_rn(a2, b1));
  return {product, third + mul_rn(a2, b2)};
#endif
}

COLLIDE_HD_INLINE double_double operator-(double_double const& x) { return {-x.high, -x.low}; }

COLLIDE_HD_INLINE double_double operator+(double_double const& x, double_double const& y) {
  double_double const s = exact_sum_of(x.high, y.high);
  return exact_sum_of_ordered(s.high, s.low + (x.low + y.low));
}

COLLIDE_HD_INLINE double_double operator-(double_double const& x, double_double const& y) { return x + -y; }

COLLIDE_HD_INLINE double_double operator*(double_double const& x, double_double const& y) {
  double_double const p = exact_product_of(x.high, y.high);
  return exact_sum_of_ordered(p.high, p.low + (mul_rn(x.high, y.low) + mul_rn(x.low, y.high)));
}

COLLIDE_HD_INLINE double_double operator/(double_double const& x, double_double const& y) {
  double const first = div_rn(x.high, y.high);
  double_double const rest = x - double_double{first, 0} * y;
  return exact_sum_of_ordered(first, div_rn(rest.high, y.high));
}

COLLIDE_HD_INLINE bool operator<(double_double const& x, double_double const& y) {
  return x.high < y.high || (x.high == y.high && x.low < y.low);
}

/// The square root of x > 0.
COLLIDE_HD_INLINE double_double root(double_double const& x) {
  double const first = sqrt_rn(x.high);
  double_double const rest = x - exact_product_of(first, first);
  return exact_sum_of_ordered(first, div_rn(rest.high, 2 * first));
}

/// x times a power of two.
COLLIDE_HD_INLINE double_double scaled(double_double const& x, double power) {
  return {mul_rn(x.high, power), mul_rn(x.low, power)};
}

/// A vector of such numbers.
struct long_vector {
  double_double x, y, z;

  COLLIDE_HD_INLINE vec3<double> rounded() const { return {x.high, y.high, z.high}; }
};

COLLIDE_HD_INLINE double_double dot(long_vector const& a, long_vector const& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

COLLIDE_HD_INLINE long_vector cross(long_vector const& a, long_vector const& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace collide::detail
