/// \file
/// Sine and cosine, the angle of a vector, the exponential function of a decay and random numbers, with the same bits
/// on host and device: fixed operations, each rounded on its own.
#pragma once

#include <cmath>
#include <cstdint>

#include <collide/core/config.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

struct sin_cos {
  double sin, cos;
};

/// Sine and cosine of an angle in radians from -pi/4 to pi/4: the series, to within 2 units in the last place.
COLLIDE_HD_INLINE sin_cos sin_cos_near_zero(double x) {
  double const y = mul_rn(x, x);
  // 1 / (k (k + 1)) of the next term, from the last on
  constexpr double by_sin[] = {1.0 / 272, 1.0 / 210, 1.0 / 156, 1.0 / 110, 1.0 / 72, 1.0 / 42, 1.0 / 20, 1.0 / 6};
  constexpr double by_cos[] = {1.0 / 240, 1.0 / 182, 1.0 / 132, 1.0 / 90, 1.0 / 56, 1.0 / 30, 1.0 / 12, 1.0 / 2};
  double s = 1, c = 1;
  for (double const f : by_sin) s = 1 - mul_rn(mul_rn(y, f), s);
  for (double const f : by_cos) c = 1 - mul_rn(mul_rn(y, f), c);
  return {mul_rn(x, s), c};
}

/// Sine and cosine of an angle in turns of 2 pi: exact at quarters of a turn, elsewhere to within 1e-15. NaN unless the
/// angle is finite.
COLLIDE_HD_INLINE sin_cos sin_cos_of_turns(double turns) {
  double const fraction = turns - std::floor(turns);  // exact, or 1 of what is just below 0
  double const quarter = std::floor(mul_rn(fraction, 4) + 0.5);
  sin_cos const near = sin_cos_near_zero(mul_rn(fraction - mul_rn(quarter, 0.25), 6.283185307179586));
  if (quarter == 1) return {near.cos, -near.sin};
  if (quarter == 2) return {-near.sin, -near.cos};
  if (quarter == 3) return {-near.cos, near.sin};
  return near;
}

/// The angle of (x, y) in radians, from -pi to pi, to within 2^-50; 0 of (0, 0). Finite numbers whose quotient does not
/// matter where it underflows.
COLLIDE_HD_INLINE double angle_of(double y, double x) {
  constexpr double pi = 3.141592653589793;
  double const across = y < 0 ? -y : y, along = x < 0 ? -x : x;
  double const smaller = min(across, along), larger = max(across, along);
  if (!(larger > 0)) return 0;
  // atan(t) = pi/4 + atan((t - 1) / (t + 1)), where t is above tan(pi/8)
  bool const steep = smaller > mul_rn(larger, 0.41421356237309503);
  double const t = steep ? div_rn(smaller - larger, smaller + larger) : div_rn(smaller, larger), tt = mul_rn(t, t);
  constexpr double coefficients[] = {1.0 / 43, 1.0 / 41, 1.0 / 39, 1.0 / 37, 1.0 / 35, 1.0 / 33, 1.0 / 31, 1.0 / 29,
                                     1.0 / 27, 1.0 / 25, 1.0 / 23, 1.0 / 21, 1.0 / 19, 1.0 / 17, 1.0 / 15, 1.0 / 13,
                                     1.0 / 11, 1.0 / 9,  1.0 / 7,  1.0 / 5,  1.0 / 3,  1.0};
  double series = 0;
  for (double const fraction : coefficients) series = fraction - mul_rn(tt, series);
  double angle = (steep ? pi / 4 : 0) + mul_rn(t, series);
  if (across > along) angle = pi / 2 - angle;
  if (x < 0) angle = pi - angle;
  return y < 0 ? -angle : angle;
}

/// The rest after the time z of 1 that decays by itself per unit of time, and the loss.
struct decay {
  double left, lost;  ///< e^-z and 1 - e^-z
};

/// The decay after z >= 0: both to within 2 units in the last place, but `left` is 0 for z above 690. NaN for NaN.
COLLIDE_HD_INLINE decay decay_after(double z) {
  if (!(z <= 690)) return {z > 690 ? 0 : z, z > 690 ? 1 : z};
  int const count = static_cast<int>(mul_rn(z, 1.4426950408889634) + 0.5);
  double const halvings = count;
  // z - halvings ln 2: the first part of ln 2 has so few digits that its product is exact
  double const x = mul_rn(halvings, 6.93147180369123816490e-01) - z + mul_rn(halvings, 1.90821492927058770002e-10);
  // 1 / k of the series (e^x - 1) / x = 1 + x / 2 (1 + x / 3 (...)), from the last on
  constexpr double by[] = {1.0 / 15, 1.0 / 14, 1.0 / 13, 1.0 / 12, 1.0 / 11, 1.0 / 10, 1.0 / 9,
                           1.0 / 8,  1.0 / 7,  1.0 / 6,  1.0 / 5,  1.0 / 4,  1.0 / 3,  1.0 / 2};
  double s = 1;
  for (double const f : by) s = 1 + mul_rn(mul_rn(x, f), s);
  double const more = mul_rn(x, s);  // e^x - 1, |x| at most 0.35
  double const scale = from_bits<double>(static_cast<std::uint64_t>(1023 - count) << 52);
  return {mul_rn(scale, 1 + more), (1 - scale) - mul_rn(scale, more)};
}

/// From 0 to below 1, always the same for a number: splitmix64 by S. Vigna.
COLLIDE_HD_INLINE double random_fraction(std::uint64_t number) {
  std::uint64_t z = (number + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-53;
}

}  // namespace collide::detail
