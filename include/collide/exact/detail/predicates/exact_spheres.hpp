/// \file
/// The test if two spheres touch, in exact arithmetic.
#pragma once

#include <collide/exact/detail/numeric/exact_sum.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// True if |a - b| <= r + s, of finite coordinates and valid finite radii: (a - b)^2 - (r + s)^2 as a sum of products
/// in integers.
COLLIDE_HD_NOINLINE inline bool spheres_touch_in_integers(sphere<double> const& a, sphere<double> const& b) {
  exact_memory<4 * 2, 4> memory;
  exact_numbers numbers = memory.table();
  exact_products sum;
  for (int k = 0; k < 3; ++k) {
    numbers.begin_number();
    numbers.add(decoded(a.centre[k]));
    numbers.subtract(decoded(b.centre[k]));
    sum.add(1, k, k);
  }
  numbers.begin_number();
  numbers.add(decoded(a.radius));
  numbers.add(decoded(b.radius));
  sum.add(-1, 3, 3);
  return exact_sum::sign_of(numbers, sum) <= 0;
}

/// True if two spheres with their surfaces have a point in common. Finite coordinates; valid radii, of which those that
/// are infinite reach everything. Seven sums and products in double decide nearly all: a sum of squares has a relative
/// error below 2^-50, and is off by less than 2^-140 where it is so small that something vanishes or is flushed to 0.
template <class S>
COLLIDE_HD_INLINE bool spheres_touch(sphere<S> const& a, sphere<S> const& b) {
  auto const wide = [](S x) { return static_cast<double>(x); };
  vec3<double> const between(wide(a.centre.x()) - wide(b.centre.x()), wide(a.centre.y()) - wide(b.centre.y()),
                             wide(a.centre.z()) - wide(b.centre.z()));
  double const reach = wide(a.radius) + wide(b.radius);
  double const distance_squared = dot(between, between), reach_squared = mul_rn(reach, reach);
  double const error = mul_rn(distance_squared + reach_squared, 0x1p-49) + 0x1p-140;
  if (distance_squared - reach_squared > error) return false;
  if (reach_squared - distance_squared > error) return true;
  if (is_infinite(a.radius) || is_infinite(b.radius)) return true;
  return spheres_touch_in_integers(widened(a), widened(b));
}

}  // namespace collide::detail
