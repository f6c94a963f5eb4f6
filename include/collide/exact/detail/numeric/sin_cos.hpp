/// \file
/// Sine and cosine with the same bits on host and device: fixed operations, each rounded on its own.
#pragma once

#include <cmath>

#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// The sine and the cosine of an angle.
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
  double const part = turns - std::floor(turns);  // exact, or 1 of what is just below 0
  double const quarter = std::floor(mul_rn(part, 4) + 0.5);
  sin_cos const near = sin_cos_near_zero(mul_rn(part - mul_rn(quarter, 0.25), 6.283185307179586));
  if (quarter == 1) return {near.cos, -near.sin};
  if (quarter == 2) return {-near.sin, -near.cos};
  if (quarter == 3) return {-near.cos, near.sin};
  return near;
}

}  // namespace collide::detail
