/// \file
/// Karabassi's sphere/triangle intersection test.
#pragma once

#include <collide/core/contact.hpp>
#include <collide/core/precision.hpp>
#include <collide/exact/detail/geometry/closest_point.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>
#include <collide/narrow/detail/contact.hpp>
#include <collide/narrow/detail/contact_in_precision.hpp>
#include <collide/narrow/detail/intersects.hpp>

namespace collide {

namespace detail {

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

}  // namespace detail

/// Narrow phase: the static case of the particle/triangle test of E.-A. Karabassi, G. Papaioannou, T. Theoharis and
/// A. Boehm, "Intersection test for collision detection in particle systems", J. Graphics Tools 4(1), 1999, in four
/// steps: (1) the plane is farther than the radius: miss; (2) a vertex lies in the sphere: hit; (3) the centre projects
/// into the triangle: hit; (4) a point on an edge lies in the sphere: hit; otherwise miss.
///
/// `Precision` is the precision of the test and of contacts: `exact` (verdicts are never wrong, distance and depth are
/// within 4 units in the last place), `double_precision`, `single_precision` or `baseline`; see precision.hpp, and
/// docs/accuracy.md for the cost of each.
///
/// A degenerate triangle is treated as a segment or a point. A NaN or infinite coordinate and a NaN or negative radius
/// never collide; an infinite radius always does where the geometry is finite. (`baseline` promises none of this.)
template <class Precision = exact>
struct karabassi {
  static_assert(detail::is_precision<Precision>::value,
                "collide: the parameter of karabassi is a precision, such as exact or single_precision: a class with a "
                "member type scalar");

  /// True if sphere and triangle, both with their boundaries, have a point in common. O(1).
  template <class S>
  static COLLIDE_HD_INLINE bool intersects(triangle<S> const& t, sphere<S> const& s) {
    if constexpr (std::is_same<Precision, exact>::value) {
      return detail::intersects_exact(t, s).hit;
    } else if constexpr (std::is_same<Precision, baseline>::value) {
      return detail::karabassi_world<float>(t, s);
    } else {
      return detail::karabassi_local<typename Precision::scalar>(t, s);
    }
  }

  /// Contact of a colliding pair; the caller sets the ids. O(1).
  template <class S>
  static COLLIDE_HD contact<S> contact_of(triangle<S> const& t, sphere<S> const& s) {
    if constexpr (std::is_same<Precision, exact>::value) {
      return detail::contact_of_pair(t, s);
    } else {
      return detail::contact_of_pair_in_precision<typename Precision::scalar>(t, s);
    }
  }
};

namespace detail {

template <>
struct filtered_predicate<karabassi<exact>> : exact_predicate {};

}  // namespace detail

}  // namespace collide
