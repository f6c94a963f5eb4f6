/// \file
/// The point of a triangle closest to a sphere's centre, in coordinates local to the sphere, and its measures.
#pragma once

#include <collide/core/contact.hpp>
#include <collide/exact/detail/geometry/local_triangle.hpp>

namespace collide::detail {

/// True if the origin projects strictly inside the triangle along its normal `n`; then `closest` is where, as a convex
/// combination of the corners, and so a point of the triangle even where `n` is inaccurate.
template <class T>
COLLIDE_HD_INLINE bool project_onto_face(local_triangle<T> const& t, vec3<T> const& n, vec3<T>& closest) {
  T const wa = dot(cross(t.b, t.c), n), wb = dot(cross(t.c, t.a), n), wc = dot(cross(t.a, t.b), n);
  if (!(wa > 0 && wb > 0 && wc > 0)) return false;
  T const sum = wa + wb + wc;
  closest = t.a + (scaled<T>(t.b - t.a, div_rn(wb, sum)) + scaled<T>(t.c - t.a, div_rn(wc, sum)));
  return true;
}

/// The closest point of a triangle to the origin, and the feature that it lies in.
template <class T>
struct closest_point {
  vec3<T> point;
  T distance_squared;
  feature kind;
  int index;
};

/// How a point lies to a sphere: the distance from the centre, and how deep that is inside.
struct separation {
  double distance, depth;
};

struct contact_without_point {
  separation measured;
  vec3<double> normal;
  feature kind;
  int index;
};

/// Closest point to the origin; the feature tests are those of C. Ericson, Real-Time Collision Detection, 5.1.5, taken
/// edge by edge, so that segments and points need no special case.
template <class T>
COLLIDE_HD inline closest_point<T> closest_to_origin(local_triangle<T> const& t, vec3<T> const& n) {
  closest_point<T> best{t.a, dot(t.a, t.a), feature::vertex, 0};
  auto const consider = [&](vec3<T> const& p, feature kind, int index) COLLIDE_HOT {
    T const d = dot(p, p);
    if (d < best.distance_squared) best = {p, d, kind, index};
  };
  consider(t.b, feature::vertex, 1);
  consider(t.c, feature::vertex, 2);
  auto const edge = [&](vec3<T> const& a, vec3<T> const& b, int index) COLLIDE_HOT {
    vec3<T> const e = b - a;
    T const along = -dot(a, e), ee = dot(e, e);
    if (along > 0 && along < ee) consider(a + scaled(e, div_rn(along, ee)), feature::edge, index);
  };
  edge(t.a, t.b, 0);
  edge(t.b, t.c, 1);
  edge(t.c, t.a, 2);
  vec3<T> closest;
  if (project_onto_face(t, n, closest) && dot(closest, closest) <= best.distance_squared) {
    best = {closest, dot(closest, closest), feature::face, 0};
  }
  return best;
}

}  // namespace collide::detail
