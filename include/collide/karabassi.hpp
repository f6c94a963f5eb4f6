/// \file
/// Karabassi's sphere/triangle intersection test.
#pragma once

#include <collide/contact.hpp>
#include <collide/detail/arithmetic.hpp>
#include <collide/detail/closest_point.hpp>
#include <collide/precision.hpp>

namespace collide {

/// Narrow phase: the static case of the particle/triangle test of E.-A. Karabassi, G. Papaioannou, T. Theoharis and
/// A. Boehm, "Intersection test for collision detection in particle systems", J. Graphics Tools 4(1), 1999, in four
/// steps: (1) the plane is farther than the radius: miss; (2) a vertex lies in the sphere: hit; (3) the centre projects
/// into the triangle: hit; (4) a point on an edge lies in the sphere: hit; otherwise miss.
///
/// The centre is subtracted from the vertices first and all arithmetic is done in these local coordinates, scaled by a
/// power of two so that nothing overflows: the error is then relative to the size of the triangle as seen from the
/// sphere and not to the distance of both from the origin.
///
/// A hit is only ever reported for a point of the triangle that was found within the radius, and the plane rejects only
/// where its distance is certain, so slivers do no harm and degenerate triangles are the segment or point that they
/// are. A NaN or infinite coordinate and a NaN or negative radius never collide; an infinite radius always does where
/// the geometry is finite. `Precision` names the arithmetic of the verdict; the contact of a colliding pair is always
/// computed in double.
template <class Precision = single_precision>
struct karabassi {
  static_assert(detail::is_precision<Precision>::value,
                "collide: the parameter of karabassi is a precision, such as single_precision: a class with a member "
                "type scalar");

  /// True if the closed ball touches the closed triangle.
  template <class S>
  static COLLIDE_HD_INLINE bool intersects(triangle<S> const& t, sphere<S> const& s) {
    using T = typename Precision::scalar;
    using W = std::common_type_t<S, T>;
    detail::local_triangle<W> const l = detail::relative<W>(t, s);
    if (!detail::box_in_reach(l)) return false;
    if (!detail::valid_radius(s.radius) || !detail::finite(s.centre) || !detail::finite(t)) return false;
    return detail::infinite(s.radius) || four_steps(detail::rounded<T>(detail::normalised(l, t, s)));
  }

  /// Where and how a colliding pair touches; the ids are left to the caller. O(1), computed in double.
  template <class S>
  static COLLIDE_HD contact<S> contact_of(triangle<S> const& t, sphere<S> const& s) {
    return detail::contact_in_double(t, s);
  }

 private:
  template <class T>
  static COLLIDE_HD_INLINE bool four_steps(detail::local_triangle<T> const& t) {
    using namespace detail;
    T const rr = mul(t.radius, t.radius);
    vec3<T> const u = t.b - t.a, v = t.c - t.a, n = cross(u, v);
    if (plane_out_of_reach(t.a, n, mul(dot(u, u), dot(v, v)), rr)) return false;           // 1: the plane
    if (smaller(smaller(dot(t.a, t.a), dot(t.b, t.b)), dot(t.c, t.c)) <= rr) return true;  // 2: the vertices
    vec3<T> foot;
    if (foot_inside(t, n, foot) && dot(foot, foot) <= rr) return true;               // 3: the face
    return on_edge(t.a, t.b, rr) || on_edge(t.b, t.c, rr) || on_edge(t.c, t.a, rr);  // 4: the edges
  }

  /// True if the distance |n.a| / |n| of the plane is beyond the radius by more than an eighth and the rounding of n,
  /// which is relative to `uuvv`, the product of the squared sides, and so overwhelms the normal of a sliver.
  template <class T>
  static COLLIDE_HD_INLINE bool plane_out_of_reach(vec3<T> const& a, vec3<T> const& n, T uuvv, T rr) {
    using namespace detail;
    constexpr T error = 512 * format<T>::unit * format<T>::unit;
    T const d = dot(n, a);
    return mul(mul(d, d), T(0.875)) > mul(rr, dot(n, n)) + mul(mul(error, uuvv), dot(a, a));
  }

  /// True if a point strictly between a and b is within the root of `rr` of the origin.
  template <class T>
  static COLLIDE_HD_INLINE bool on_edge(vec3<T> const& a, vec3<T> const& b, T rr) {
    using namespace detail;
    vec3<T> const e = b - a;
    T const along = -dot(a, e);
    T const ee = dot(e, e);
    if (!(along > 0 && along < ee)) return false;
    vec3<T> const q = a + scaled(e, div(along, ee));
    return dot(q, q) <= rr;
  }
};

}  // namespace collide
