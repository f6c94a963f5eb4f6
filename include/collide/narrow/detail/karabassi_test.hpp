/// \file
/// The four steps of Karabassi's test, in plain arithmetic: in world coordinates, and in coordinates local to the
/// sphere.
#pragma once

#include <collide/exact/detail/geometry/closest_point.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// True if the distance |n.a| / |n| of the plane is beyond the radius by more than an eighth and the rounding of n,
/// which is relative to `uuvv`, the product of the squared sides, and so overwhelms the normal of a sliver.
template <class T>
COLLIDE_HD_INLINE bool plane_separates(vec3<T> const& a, vec3<T> const& n, T uuvv, T rr) {
  constexpr T error = 512 * ieee_traits<T>::unit_roundoff * ieee_traits<T>::unit_roundoff;
  T const d = dot(n, a);
  return mul_rn(mul_rn(d, d), T(0.875)) > mul_rn(rr, dot(n, n)) + mul_rn(mul_rn(error, uuvv), dot(a, a));
}

/// True if a point strictly between a and b is within the root of `rr` of the origin.
template <class T>
COLLIDE_HD_INLINE bool edge_intersects(vec3<T> const& a, vec3<T> const& b, T rr) {
  vec3<T> const e = b - a;
  T const along = -dot(a, e);
  T const ee = dot(e, e);
  if (!(along > 0 && along < ee)) return false;
  vec3<T> const q = a + scaled(e, div_rn(along, ee));
  return dot(q, q) <= rr;
}

/// The four steps in coordinates local to the sphere and scaled by a power of two, so that errors are relative to the
/// triangle as seen from the sphere and nothing overflows. A hit is only ever reported for a point of the triangle that
/// was found within the radius, and the plane rejects only where its distance is certain.
template <class T, class S>
COLLIDE_HD_INLINE bool karabassi_local(triangle<S> const& of, sphere<S> const& s) {
  using W = std::common_type_t<S, T>;
  local_triangle<W> const l = to_local<W>(of, s);
  if (!aabb_within(l, l.radius)) return false;
  if (!is_valid_radius(s.radius) || !is_finite(s.centre) || !is_finite(of)) return false;
  if (is_infinite(s.radius)) return true;
  local_triangle<T> const t = narrow_to<T>(to_unit_range(l, of, s));
  T const rr = mul_rn(t.radius, t.radius);
  vec3<T> const u = t.b - t.a, v = t.c - t.a, n = cross(u, v);
  if (plane_separates(t.a, n, mul_rn(dot(u, u), dot(v, v)), rr)) return false;   // 1: the plane
  if (min(min(dot(t.a, t.a), dot(t.b, t.b)), dot(t.c, t.c)) <= rr) return true;  // 2: the vertices
  vec3<T> closest;
  if (project_onto_face(t, n, closest) && dot(closest, closest) <= rr) return true;  // 3: the face
  return edge_intersects(t.a, t.b, rr) || edge_intersects(t.b, t.c, rr) ||
         edge_intersects(t.c, t.a, rr);  // 4: the edges
}

/// The four steps in `T` and in world coordinates, as in the literature.
template <class T, class S>
COLLIDE_HD_INLINE bool karabassi_world(triangle<S> const& of, sphere<S> const& s) {
  vec3<T> const a = cast_to<T>(of.a), b = cast_to<T>(of.b), c = cast_to<T>(of.c);
  vec3<T> const p = cast_to<T>(s.centre);
  T const r = static_cast<T>(s.radius);
  auto const within = [&](vec3<T> const& q) { return (q - p).dot(q - p) <= r * r; };
  vec3<T> n = cross<T>(b - a, c - a);
  n = n / sqrt_rn(n.dot(n));
  T const d = n.dot(p - a);
  if (d > r || d < -r) return false;                     // 1: the plane
  if (within(a) || within(b) || within(c)) return true;  // 2: the vertices
  vec3<T> const closest = p - d * n;
  auto const left_of = [&](vec3<T> const& from, vec3<T> const& to) {
    return n.dot(cross<T>(to - from, closest - from)) >= 0;
  };
  if (left_of(a, b) && left_of(b, c) && left_of(c, a)) return true;  // 3: the face
  auto const edge = [&](vec3<T> const& from, vec3<T> const& to) {
    vec3<T> const e = to - from;
    T const along = e.dot(p - from) / e.dot(e);
    return along >= 0 && along <= 1 && within(from + along * e);
  };
  return edge(a, b) || edge(b, c) || edge(c, a);  // 4: the edges
}

}  // namespace collide::detail
