/// \file
/// The floating-point filter for moving spheres; see filter.hpp.
///
/// As seen from the sphere the triangle sweeps out a prism, whose corners are the triangle's and the same less the
/// displacement. A witness in the prism makes a hit, a direction in which all six corners are far makes a miss. Every
/// line is proved in docs/numerics.md.
#pragma once

#include <collide/detail/geometry/closest_approach.hpp>
#include <collide/detail/predicates/filter.hpp>

namespace collide::detail {

/// Lengths of a sweep are known to within this times the size.
template <class T>
inline constexpr T sweep_error = 2 * certificate_bounds<T>::error;

/// Filtered test whether the triangle comes within the radius of the centre's path. `size` is `size_of(l)`, between the
/// bounds. Coordinates may be off by `format<T>::unit` times the size. Invalid input is never a certain hit.
template <class T>
COLLIDE_HD_INLINE verdict certify(local_sweep<T> const& l, T size) {
  local_triangle<T> const& t = l.shape;
  T const error = mul(sweep_error<T>, size), outer = t.radius + error;
  if (!box_in_reach(l, outer)) return verdict::miss;

  auto const beyond = [&](vec3<T> const& g, T gg) {
    T const least =
        smaller(smaller(fused_dot(t.a, g), fused_dot(t.b, g)), fused_dot(t.c, g)) - larger(fused_dot(l.path, g), T(0));
    return gg >= certificate_bounds<T>::shortest && least > 0 && mul(least, least) > mul(mul(outer, outer), gg);
  };
  // for most, the direction to the middle of the prism separates
  vec3<T> const middle = (t.a + t.b + t.c) - scaled(l.path, T(1.5));
  if (beyond(middle, fused_dot(middle, middle))) return verdict::miss;

  closest_approach<T> const near = approach(l);
  T const v = clamped(near.v), w = smaller(clamped(near.w), T(1) - v), time = clamped(near.time);
  auto const combined = [&](int k) { return t.a[k] + fused(v, t.b[k] - t.a[k], mul(w, t.c[k] - t.a[k])); };
  vec3<T> const q = vec3<T>(combined(0), combined(1), combined(2)) - scaled(l.path, time);
  T const s = fused_dot(q, q);
  // decided on bits; not finite if some coordinate is not
  if (!finite(s) || !valid_radius(t.radius)) return verdict::unsure;

  T const inner = t.radius - error;
  if (inner > 0 && s <= mul(inner, inner)) return verdict::hit;

  if (beyond(q, s)) return verdict::miss;
  vec3<T> n = near.normal;  // has a smaller relative error than a short q
  if (fused_dot(n, q) < 0) n = -n;
  return beyond(n, fused_dot(n, n)) ? verdict::miss : verdict::unsure;
}

}  // namespace collide::detail
