/// \file
/// The point of a triangle closest to a sphere's centre, in coordinates local to the sphere.
#pragma once

#include <collide/contact.hpp>
#include <collide/detail/arithmetic.hpp>

namespace collide::detail {

/// A triangle as seen from a sphere's centre: local coordinates times `scale`, a power of two.
template <class T>
struct local_triangle {
  vec3<T> a, b, c;
  T radius;
  T scale;
};

/// The largest of |x|, |y| and |z|.
template <class T>
COLLIDE_HD_INLINE T magnitude(vec3<T> const& v) {
  return largest<T>(v.cwiseAbs());
}

/// Subtracts the centre. `W` holds all values of `S`.
template <class W, class S>
COLLIDE_HD_INLINE local_triangle<W> relative(triangle<S> const& t, sphere<S> const& s) {
  vec3<S> const& c = s.centre;
  auto const from_centre = [&](vec3<S> const& v) -> vec3<W> {
    return {W(v.x()) - W(c.x()), W(v.y()) - W(c.y()), W(v.z()) - W(c.z())};
  };
  return {from_centre(t.a), from_centre(t.b), from_centre(t.c), W(s.radius), W(1)};
}

/// `relative` scaled so that its largest coordinate and the radius are below 4 and the larger of them is at least 1,
/// unless they are tiny. Finite input only.
template <class W, class S>
COLLIDE_HD_INLINE local_triangle<W> normalised(local_triangle<W> l, triangle<S> const& t, sphere<S> const& s) {
  auto const size = [&] { return larger(larger(magnitude(l.a), magnitude(l.b)), larger(magnitude(l.c), l.radius)); };
  if constexpr (sizeof(W) == sizeof(S)) {
    if (!finite(size())) {  // a difference was beyond the range
      constexpr W tiny = std::numeric_limits<W>::min();
      l = relative<W>(triangle<S>{scaled(t.a, tiny), scaled(t.b, tiny), scaled(t.c, tiny)},
                      sphere<S>{scaled(s.centre, tiny), mul(s.radius, tiny)});
      l.scale = tiny;
    }
  }
  W const scale = reciprocal_power(size());
  return {scaled(l.a, scale), scaled(l.b, scale), scaled(l.c, scale), mul(l.radius, scale), mul(l.scale, scale)};
}

/// Rounds scaled local coordinates to `T`, whose range they fit.
template <class T, class W>
COLLIDE_HD_INLINE local_triangle<T> rounded(local_triangle<W> const& l) {
  return {l.a.template cast<T>(), l.b.template cast<T>(), l.c.template cast<T>(), static_cast<T>(l.radius), T(0)};
}

/// False if the triangle's box is farther from the origin than the radius along some axis. Exact: rounding is monotone.
template <class T>
COLLIDE_HD_INLINE bool box_in_reach(local_triangle<T> const& t) {
  vec3<T> const lower = smaller(smaller(t.a, t.b), t.c), upper = larger(larger(t.a, t.b), t.c);
  return largest<T>(lower) <= t.radius && largest<T>(-upper) <= t.radius;
}

/// False if the normal (of squared length `nn`) of the triangle drowns in rounding: its corners are (nearly) collinear.
template <class T>
COLLIDE_HD_INLINE bool spans_plane(local_triangle<T> const& t, T nn) {
  vec3<T> const u = t.b - t.a, v = t.c - t.a;
  constexpr T small = 64 * format<T>::unit;
  return nn > mul(mul(small, small), mul(dot(u, u), dot(v, v)));
}

/// True if the origin projects strictly inside the triangle along its normal `n`; then `foot` is where, as a convex
/// combination of the corners, and so a point of the triangle even where `n` is inaccurate.
template <class T>
COLLIDE_HD_INLINE bool foot_inside(local_triangle<T> const& t, vec3<T> const& n, vec3<T>& foot) {
  T const wa = dot(cross(t.b, t.c), n), wb = dot(cross(t.c, t.a), n), wc = dot(cross(t.a, t.b), n);
  if (!(wa > 0 && wb > 0 && wc > 0)) return false;
  T const sum = wa + wb + wc;
  foot = t.a + (scaled<T>(t.b - t.a, div(wb, sum)) + scaled<T>(t.c - t.a, div(wc, sum)));
  return true;
}

/// The closest point of a triangle to the origin, and the part of the triangle that it lies in.
template <class T>
struct closest_point {
  vec3<T> point;
  T distance_squared;
  feature kind;
  int index;
};

/// Closest point to the origin; the feature tests are those of C. Ericson, Real-Time Collision Detection, 5.1.5, taken
/// edge by edge, so that segments and points need no special case.
template <class T>
COLLIDE_HD inline closest_point<T> closest_to_origin(local_triangle<T> const& t, vec3<T> const& n) {
  closest_point<T> best{t.a, dot(t.a, t.a), feature::vertex, 0};
  auto const offer = [&](vec3<T> const& p, feature kind, int index) {
    T const d = dot(p, p);
    if (d < best.distance_squared) best = {p, d, kind, index};
  };
  offer(t.b, feature::vertex, 1);
  offer(t.c, feature::vertex, 2);
  auto const edge = [&](vec3<T> const& a, vec3<T> const& b, int index) {
    vec3<T> const e = b - a;
    T const along = -dot(a, e), ee = dot(e, e);
    if (along > 0 && along < ee) offer(a + scaled(e, div(along, ee)), feature::edge, index);
  };
  edge(t.a, t.b, 0);
  edge(t.b, t.c, 1);
  edge(t.c, t.a, 2);
  vec3<T> foot;
  if (foot_inside(t, n, foot) && dot(foot, foot) <= best.distance_squared) {
    best = {foot, dot(foot, foot), feature::face, 0};
  }
  return best;
}

/// Unit vector along `v`, which is not zero.
template <class T>
COLLIDE_HD inline vec3<T> unit(vec3<T> const& v) {
  vec3<T> const w = scaled(v, reciprocal_power(magnitude(v)));
  return scaled(w, div(T(1), root(dot(w, w))));
}

/// A unit vector perpendicular to `v`, or (0, 0, 1) if `v` is zero.
template <class T>
COLLIDE_HD inline vec3<T> perpendicular(vec3<T> const& v) {
  vec3<T> const m = v.cwiseAbs();
  if (m.x() == 0 && m.y() == 0) return m.z() == 0 ? vec3<T>{0, 0, 1} : vec3<T>{1, 0, 0};
  return m.z() >= larger(m.x(), m.y()) ? unit<T>({0, -v.z(), v.y()}) : unit<T>({-v.y(), v.x(), 0});
}

/// A normal of the triangle; of a segment or a point some unit vector perpendicular to it.
template <class T>
COLLIDE_HD inline vec3<T> normal_of(local_triangle<T> const& t, vec3<T> const& n, bool plane) {
  if (plane) return unit(n);
  vec3<T> const ab = t.b - t.a, bc = t.c - t.b, ca = t.a - t.c;
  T const x = dot(ab, ab), y = dot(bc, bc), z = dot(ca, ca);
  return perpendicular(x >= y && x >= z ? ab : (y >= z ? bc : ca));
}

/// The contact of a finite triangle and sphere, computed in double and rounded once; the ids are left to the caller.
template <class S>
COLLIDE_HD contact<S> contact_in_double(triangle<S> const& t, sphere<S> const& s) {
  sphere<S> const centre{s.centre, S(0)};
  local_triangle<double> const l = normalised(relative<double>(t, centre), t, centre);
  vec3<double> const n = cross<double>(l.b - l.a, l.c - l.a);
  closest_point<double> const q = closest_to_origin(l, n);
  vec3<double> normal;
  // a point on an edge is off by rounding, so closer than this its direction means nothing; l is at most 4
  constexpr double noise = 32 * format<double>::unit;
  if (q.distance_squared <= (q.kind == feature::edge ? noise * noise : 0)) {
    normal = normal_of(l, n, spans_plane(l, dot(n, n)));
  } else if (q.kind == feature::face) {
    normal = unit(n);
    if (dot(l.a, n) > 0) normal = -normal;
  } else {
    normal = unit<double>(-q.point);
  }
  double const distance = div(root(q.distance_squared), l.scale);
  vec3<double> const point = s.centre.template cast<double>() + scaled(q.point, div(1.0, l.scale));
  return {no_id,
          no_id,
          point.template cast<S>(),
          normal.template cast<S>(),
          static_cast<S>(distance),
          static_cast<S>(static_cast<double>(s.radius) - distance),
          q.kind,
          static_cast<std::uint32_t>(q.index)};
}

}  // namespace collide::detail
