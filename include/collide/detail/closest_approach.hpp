/// \file
/// Where the way of a moving sphere's centre and a triangle come closest.
#pragma once

#include <collide/detail/local_sweep.hpp>

namespace collide::detail {

/// A place on the way, as a time, and a point of the triangle, as the weights of its second and third corner. All are
/// fractions, also where arithmetic was inaccurate, so that the two places are what they claim to be.
template <class T>
struct closest_approach {
  T time, v, w;
  vec3<T> offset;  ///< from the place on the way to the point of the triangle
  T distance_squared;
  vec3<T> normal;  ///< perpendicular to what the two lie in: way and edge, or face; not of length 1
};

/// x / y limited to 0 .. 1; 0 unless y > 0.
template <class T>
COLLIDE_HD_INLINE T fraction(T x, T y) {
  return y > std::numeric_limits<T>::min() ? clamped(div(x, y)) : T(0);
}

/// The closest approach is that to an edge, or to the face where the way meets the plane or comes nearest to it. (If
/// it is to the face and the way is parallel to that, it is to an edge as well, or at the beginning or the end.)
template <class T>
COLLIDE_HD_INLINE closest_approach<T> approach(local_sweep<T> const& l) {
  vec3<T> const& d = l.path;
  local_triangle<T> const& t = l.shape;
  T const dd = dot(d, d);
  closest_approach<T> best{T(0), T(0), T(0), t.a, dot(t.a, t.a), vec3<T>(T(0), T(0), T(0))};
  auto const offer = [&](T time, T v, T w, vec3<T> const& offset, vec3<T> const& normal) {
    T const square = dot(offset, offset);
    if (square <= best.distance_squared) best = {time, v, w, offset, square, normal};
  };
  // Two lines, after C. Ericson, Real-Time Collision Detection, 5.1.9: the time that is the best on the whole line of
  // the edge, the best place on the edge for that time, and the best time for that place.
  auto const along = [&](vec3<T> const& from, vec3<T> const& to, auto const& weights) {
    vec3<T> const e = to - from;
    T const ee = dot(e, e), de = dot(d, e), ev = dot(e, from), dv = dot(d, from);
    T const first = fraction(mul(dv, ee) - mul(de, ev), mul(dd, ee) - mul(de, de));
    T const part = fraction(mul(de, first) - ev, ee);
    T const time = fraction(mul(de, part) + dv, dd);
    weights(part, time, from + scaled(e, part) - scaled(d, time), cross(d, e));
  };
  along(t.a, t.b, [&](T f, T time, auto const& o, auto const& n) { offer(time, f, T(0), o, n); });
  along(t.b, t.c, [&](T f, T time, auto const& o, auto const& n) { offer(time, 1 - f, f, o, n); });
  along(t.c, t.a, [&](T f, T time, auto const& o, auto const& n) { offer(time, T(0), 1 - f, o, n); });
  vec3<T> const n = cross<T>(t.b - t.a, t.c - t.a);
  T const height = dot(t.a, n), fall = dot(d, n);
  T const time = fall < 0 ? fraction(-height, -fall) : fraction(height, fall);
  local_triangle<T> const there = seen_at(l, time);
  T const wa = dot(cross(there.b, there.c), n), wb = dot(cross(there.c, there.a), n),
          wc = dot(cross(there.a, there.b), n);
  if (wa > 0 && wb > 0 && wc > 0) {
    T const sum = wa + wb + wc, v = div(wb, sum), w = smaller(div(wc, sum), 1 - v);
    offer(time, v, w, there.a + (scaled<T>(t.b - t.a, v) + scaled<T>(t.c - t.a, w)), n);
  }
  return best;
}

}  // namespace collide::detail
