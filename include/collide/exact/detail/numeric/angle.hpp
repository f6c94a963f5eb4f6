/// \file
/// The angle of a vector in the plane with the same bits on host and device: fixed operations, each rounded on its own.
#pragma once

#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// The angle of (x, y) in radians, from -pi to pi, to within 2^-50; 0 of (0, 0). Finite numbers whose quotient does not
/// matter where it underflows.
COLLIDE_HD_INLINE double angle_of(double y, double x) {
  constexpr double pi = 3.141592653589793;
  double const across = y < 0 ? -y : y, along = x < 0 ? -x : x;
  double const least = min(across, along), most = max(across, along);
  if (!(most > 0)) return 0;
  // atan(t) = pi/4 + atan((t - 1) / (t + 1)), where t is above tan(pi/8)
  bool const steep = least > mul_rn(most, 0.41421356237309503);
  double const t = steep ? div_rn(least - most, least + most) : div_rn(least, most), tt = mul_rn(t, t);
  constexpr double parts[] = {1.0 / 43, 1.0 / 41, 1.0 / 39, 1.0 / 37, 1.0 / 35, 1.0 / 33, 1.0 / 31, 1.0 / 29,
                              1.0 / 27, 1.0 / 25, 1.0 / 23, 1.0 / 21, 1.0 / 19, 1.0 / 17, 1.0 / 15, 1.0 / 13,
                              1.0 / 11, 1.0 / 9,  1.0 / 7,  1.0 / 5,  1.0 / 3,  1.0};
  double series = 0;
  for (double const part : parts) series = part - mul_rn(tt, series);
  double angle = (steep ? pi / 4 : 0) + mul_rn(t, series);
  if (across > along) angle = pi / 2 - angle;
  if (x < 0) angle = pi - angle;
  return y < 0 ? -angle : angle;
}

}  // namespace collide::detail
