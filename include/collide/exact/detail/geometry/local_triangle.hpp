/// \file
/// Vectors and a triangle in coordinates relative to a sphere's centre.
#pragma once

#include <limits>

#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// A triangle relative to a sphere's centre, all coordinates times `scale`, a power of two.
template <class T>
struct local_triangle {
  vec3<T> a, b, c;
  T radius;
  T scale;
};

/// The largest of |x|, |y| and |z|.
template <class T>
COLLIDE_HD_INLINE T max_norm(vec3<T> const& v) {
  return max_component<T>(absolute(v));
}

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

template <class T>
COLLIDE_HD_INLINE vec3<T> longest_edge(local_triangle<T> const& t) {
  vec3<T> const ab = t.b - t.a, bc = t.c - t.b, ca = t.a - t.c;
  T const x = dot(ab, ab), y = dot(bc, bc), z = dot(ca, ca);
  return x >= y && x >= z ? ab : (y >= z ? bc : ca);
}

/// Subtracts the centre. `W` holds all values of `S`.
template <class W, class S>
COLLIDE_HD_INLINE local_triangle<W> to_local(triangle<S> const& t, sphere<S> const& s) {
  vec3<S> const& c = s.centre;
  auto const from_centre = [&](vec3<S> const& v) -> vec3<W> {
    return {opaque_value(W(v.x()) - W(c.x())), opaque_value(W(v.y()) - W(c.y())), opaque_value(W(v.z()) - W(c.z()))};
  };
  return {from_centre(t.a), from_centre(t.b), from_centre(t.c), W(s.radius), W(1)};
}

/// The largest absolute value of all coordinates and the radius.
template <class T>
COLLIDE_HD_INLINE T max_norm(local_triangle<T> const& t) {
  return max(max(max_norm(t.a), max_norm(t.b)), max(max_norm(t.c), t.radius));
}

/// The problem scaled by a power of two.
template <class T>
COLLIDE_HD_INLINE local_triangle<T> scaled(local_triangle<T> const& t, T s) {
  return {scaled(t.a, s), scaled(t.b, s), scaled(t.c, s), mul_rn(t.radius, s), mul_rn(t.scale, s)};
}

/// `relative` scaled so that its largest coordinate and the radius are below 4 and the larger of them is at least 1,
/// unless they are tiny. Finite input only.
template <class W, class S>
COLLIDE_HD_INLINE local_triangle<W> to_unit_range(local_triangle<W> l, triangle<S> const& t, sphere<S> const& s) {
  if constexpr (sizeof(W) == sizeof(S)) {
    if (!is_finite(max_norm(l))) {  // a difference was beyond the range
      constexpr W tiny = std::numeric_limits<W>::min();
      l = to_local<W>(triangle<S>{scaled(t.a, tiny), scaled(t.b, tiny), scaled(t.c, tiny)},
                      sphere<S>{scaled(s.centre, tiny), mul_rn(s.radius, tiny)});
      l.scale = tiny;
    }
  }
  return scaled(l, inverse_power_of_two(max_norm(l)));
}

/// Rounds scaled local coordinates to `T`, whose range they fit.
template <class T, class W>
COLLIDE_HD_INLINE local_triangle<T> narrow_to(local_triangle<W> const& l) {
  return {cast_to<T>(l.a), cast_to<T>(l.b), cast_to<T>(l.c), static_cast<T>(l.radius), T(0)};
}

/// False if the triangle's box is farther from the origin than `reach` along some axis. Exact: rounding is monotone.
template <class T>
COLLIDE_HD_INLINE bool aabb_within(local_triangle<T> const& t, T reach) {
  vec3<T> const lower = min(min(t.a, t.b), t.c), upper = max(max(t.a, t.b), t.c);
  bool const below = max_component<T>(lower) <= reach, above = max_component<T>(-upper) <= reach;
  return below & above;
}

}  // namespace collide::detail
