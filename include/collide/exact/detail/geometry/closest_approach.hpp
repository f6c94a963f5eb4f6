/// \file
/// The closest approach of a moving point, a sphere's centre, and a triangle.
#pragma once

#include <collide/exact/detail/geometry/local_sweep.hpp>

namespace collide::detail {

/// A point of the path, as a time, and a point of the triangle, as the barycentric weights of its second and third
/// vertex. All are in 0 .. 1, also where arithmetic was inaccurate, so that both points exist.
template <class T>
struct closest_approach {
  T time, v, w;
  vec3<T> offset;  ///< from the point of the path to the point of the triangle
  T distance_squared;
  vec3<T> normal;  ///< perpendicular to path and edge, or to the face; not normalised
};

/// 1 / y, or 0 unless y > 0.
template <class T>
COLLIDE_HD_INLINE T inverse(T y) {
  return y > std::numeric_limits<T>::min() ? div_rn(T(1), y) : T(0);
}

/// The closest approach is that to an edge, or to the face where the path meets the plane or comes nearest to it.
/// (If it is to the face and the path is parallel to that, it is to an edge as well, or at the start or the end.)
template <class T>
COLLIDE_HD_INLINE closest_approach<T> approach(local_sweep<T> const& l) {
  vec3<T> const& d = l.path;
  local_triangle<T> const& t = l.shape;
  T const dd = dot(d, d), inverse_dd = inverse(dd);
  T const da = dot(d, t.a), db = dot(d, t.b), dc = dot(d, t.c);
  closest_approach<T> best{T(0), T(0), T(0), t.a, dot(t.a, t.a), vec3<T>(T(0), T(0), T(0))};
  vec3<T> edge = best.normal;
  // Two lines, after C. Ericson, Real-Time Collision Detection, 5.1.9: the time that is the best on the whole line of
  // the edge, the best place on the edge for that time, and the best time for that place.
  auto const along = [&](vec3<T> const& from, vec3<T> const& to, T d_from, T d_to, auto const& weights) {
    vec3<T> const e = to - from;
    T const ee = dot(e, e), de = d_to - d_from, ev = dot(e, from);
    T const first = saturate(mul_rn(mul_rn(d_from, ee) - mul_rn(de, ev), inverse(mul_rn(dd, ee) - mul_rn(de, de))));
    T const part = saturate(mul_rn(mul_rn(de, first) - ev, inverse(ee)));
    T const time = saturate(mul_rn(mul_rn(de, part) + d_from, inverse_dd));
    vec3<T> const offset = from + scaled(e, part) - scaled(d, time);
    T const square = dot(offset, offset);
    if (square <= best.distance_squared) {
      best.time = time;
      best.offset = offset;
      best.distance_squared = square;
      edge = e;
      weights(part);
    }
  };
  auto const weigh = [&](T v, T w) {
    best.v = v;
    best.w = w;
  };
  along(t.a, t.b, da, db, [&](T part) { weigh(part, T(0)); });
  along(t.b, t.c, db, dc, [&](T part) { weigh(1 - part, part); });
  along(t.c, t.a, dc, da, [&](T part) { weigh(T(0), 1 - part); });
  best.normal = cross(d, edge);

  vec3<T> const n = cross<T>(t.b - t.a, t.c - t.a);
  T const height = dot(t.a, n), fall = dot(d, n);
  T const time = saturate(fall < 0 ? mul_rn(-height, inverse(-fall)) : mul_rn(height, inverse(fall)));
  local_triangle<T> const there = at_time(l, time);
  T const wa = dot(cross(there.b, there.c), n), wb = dot(cross(there.c, there.a), n),
          wc = dot(cross(there.a, there.b), n);
  if (wa > 0 && wb > 0 && wc > 0) {
    T const part = div_rn(T(1), wa + wb + wc), v = saturate(mul_rn(wb, part)), w = min(mul_rn(wc, part), 1 - v);
    vec3<T> const offset = there.a + (scaled<T>(t.b - t.a, v) + scaled<T>(t.c - t.a, w));
    T const square = dot(offset, offset);
    if (square <= best.distance_squared) best = {time, v, w, offset, square, n};
  }
  return best;
}

}  // namespace collide::detail
