/// \file
/// What the ways to measure a contact share.
#pragma once

#include <collide/detail/predicates/exact.hpp>

namespace collide::detail {

/// Unit vector along `v`, which is not zero.
template <class T>
COLLIDE_HD inline vec3<T> unit(vec3<T> const& v) {
  vec3<T> const w = scaled(v, inverse_power_of_two(max_norm(v)));
  return scaled(w, div_rn(T(1), sqrt_rn(dot(w, w))));
}

/// A unit vector perpendicular to `v`, or (0, 0, 1) if `v` is zero.
template <class T>
COLLIDE_HD inline vec3<T> perpendicular(vec3<T> const& v) {
  vec3<T> const m = absolute(v);
  if (m.x() == 0 && m.y() == 0) return m.z() == 0 ? vec3<T>{0, 0, 1} : vec3<T>{1, 0, 0};
  return m.z() >= max(m.x(), m.y()) ? unit<T>({0, -v.z(), v.y()}) : unit<T>({-v.y(), v.x(), 0});
}

/// The longest edge of a triangle.
template <class T>
COLLIDE_HD_INLINE vec3<T> longest_edge(local_triangle<T> const& t) {
  vec3<T> const ab = t.b - t.a, bc = t.c - t.b, ca = t.a - t.c;
  T const x = dot(ab, ab), y = dot(bc, bc), z = dot(ca, ca);
  return x >= y && x >= z ? ab : (y >= z ? bc : ca);
}

/// A contact without its point.
struct contact_without_point {
  separation measured;
  vec3<double> normal;
  feature kind;
  int index;
};

}  // namespace collide::detail
