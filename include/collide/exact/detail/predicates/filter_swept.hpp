/// \file
/// The floating-point filter for moving spheres; see filter.hpp.
///
/// As seen from the sphere the triangle sweeps out a prism, whose corners are the triangle's and the same less the
/// displacement. A witness in the prism makes a hit, a direction in which all six corners are far makes a miss. Every
/// line is proved in docs/development/numerics.md.
#pragma once

#include <collide/exact/detail/geometry/closest_approach.hpp>
#include <collide/exact/detail/predicates/filter.hpp>

namespace collide::detail {

/// Lengths of a sweep are known to within this times the size.
template <class T>
inline constexpr T swept_error = 2 * filter_bounds<T>::error;

/// Filtered test whether the triangle comes within the radius of the centre's path. `size` is `max_norm(l)`, between
/// the bounds. Coordinates may be off by `ieee_traits<T>::unit_roundoff` times the size. Invalid input is never a
/// certain hit.
template <class T>
COLLIDE_HD_INLINE verdict filtered_test(local_sweep<T> const& l, T size) {
  local_triangle<T> const& t = l.shape;
  T const error = mul_rn(swept_error<T>, size), radius_high = t.radius + error;
  if (!aabb_within(l, radius_high)) return verdict::miss;

  auto const is_separating = [&](vec3<T> const& g, T gg) {
    T const least =
        min(min(dot_mul_add(t.a, g), dot_mul_add(t.b, g)), dot_mul_add(t.c, g)) - max(dot_mul_add(l.path, g), T(0));
    return gg >= filter_bounds<T>::shortest && least > 0 &&
           mul_rn(least, least) > mul_rn(mul_rn(radius_high, radius_high), gg);
  };
  // for most, the direction to the middle of the prism separates
  vec3<T> const middle = (t.a + t.b + t.c) - scaled(l.path, T(1.5));
  if (is_separating(middle, dot_mul_add(middle, middle))) return verdict::miss;

  closest_approach<T> const closest = approach(l);
  T const v = saturate(closest.v), w = min(saturate(closest.w), T(1) - v), time = saturate(closest.time);
  auto const combined = [&](int k) { return t.a[k] + mul_add(v, t.b[k] - t.a[k], mul_rn(w, t.c[k] - t.a[k])); };
  vec3<T> const q = vec3<T>(combined(0), combined(1), combined(2)) - scaled(l.path, time);
  T const s = dot_mul_add(q, q);
  // decided on bits; not finite if some coordinate is not
  if (!is_finite(s) || !is_valid_radius(t.radius)) return verdict::uncertain;

  T const radius_low = t.radius - error;
  if (radius_low > 0 && s <= mul_rn(radius_low, radius_low)) return verdict::hit;

  if (is_separating(q, s)) return verdict::miss;
  vec3<T> n = closest.normal;  // has a smaller relative error than a short q
  if (dot_mul_add(n, q) < 0) n = -n;
  return is_separating(n, dot_mul_add(n, n)) ? verdict::miss : verdict::uncertain;
}

}  // namespace collide::detail
