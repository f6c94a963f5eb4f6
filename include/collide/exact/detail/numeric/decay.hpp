/// \file
/// The exponential function of what decays, with the same bits on host and device: fixed operations, each rounded on
/// its own.
#pragma once

#include <collide/exact/detail/numeric/float_bits.hpp>

namespace collide::detail {

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

}  // namespace collide::detail
