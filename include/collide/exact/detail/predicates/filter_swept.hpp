/// \file
/// The floating-point filter for moving spheres; see filter.hpp.
///
/// As seen from the sphere the triangle sweeps out a prism, whose corners are the triangle's and the same less the
/// displacement. A witness in the prism makes a hit, a direction in which all six corners are far makes a miss. Every
/// line is proved in docs/development/numerics.md.
#pragma once

#include <collide/exact/detail/geometry/local_sweep.hpp>
#include <collide/exact/detail/predicates/filter.hpp>

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
  auto const along = [&](vec3<T> const& from, vec3<T> const& to, T d_from, T d_to, auto const& weights) COLLIDE_HOT {
    vec3<T> const e = to - from;
    T const ee = dot(e, e), de = d_to - d_from, ev = dot(e, from);
    T const first = saturate(mul_rn(mul_rn(d_from, ee) - mul_rn(de, ev), inverse(mul_rn(dd, ee) - mul_rn(de, de))));
    T const fraction = saturate(mul_rn(mul_rn(de, first) - ev, inverse(ee)));
    T const time = saturate(mul_rn(mul_rn(de, fraction) + d_from, inverse_dd));
    vec3<T> const offset = from + scaled(e, fraction) - scaled(d, time);
    T const square = dot(offset, offset);
    if (square <= best.distance_squared) {
      best.time = time;
      best.offset = offset;
      best.distance_squared = square;
      edge = e;
      weights(fraction);
    }
  };
  auto const weigh = [&](T v, T w) {
    best.v = v;
    best.w = w;
  };
  along(t.a, t.b, da, db, [&](T fraction) { weigh(fraction, T(0)); });
  along(t.b, t.c, db, dc, [&](T fraction) { weigh(1 - fraction, fraction); });
  along(t.c, t.a, dc, da, [&](T fraction) { weigh(T(0), 1 - fraction); });
  best.normal = cross(d, edge);

  vec3<T> const n = cross<T>(t.b - t.a, t.c - t.a);
  T const height = dot(t.a, n), fall = dot(d, n);
  T const time = saturate(fall < 0 ? mul_rn(-height, inverse(-fall)) : mul_rn(height, inverse(fall)));
  local_triangle<T> const there = at_time(l, time);
  T const wa = dot(cross(there.b, there.c), n), wb = dot(cross(there.c, there.a), n),
          wc = dot(cross(there.a, there.b), n);
  if (wa > 0 && wb > 0 && wc > 0) {
    T const fraction = div_rn(T(1), wa + wb + wc), v = saturate(mul_rn(wb, fraction)),
            w = min(mul_rn(wc, fraction), 1 - v);
    vec3<T> const offset = there.a + (scaled<T>(t.b - t.a, v) + scaled<T>(t.c - t.a, w));
    T const square = dot(offset, offset);
    if (square <= best.distance_squared) best = {time, v, w, offset, square, n};
  }
  return best;
}

/// Lengths of a sweep are known to within this times the size.
template <class T>
inline constexpr T swept_error = 2 * filter_bounds<T>::error;

/// Filtered test whether the triangle comes within the radius of the centre's path. `size` is `max_norm(l)`, between
/// the bounds. Coordinates may be off by `ieee_traits<T>::unit_roundoff` times the size. Invalid input is never a
/// certain hit.
template <class T>
COLLIDE_HD_INLINE verdict filtered_test(local_sweep<T> const& l, T size) {
  local_triangle<T> const& t = l.shape;
  T const error = mul_rn(swept_error<T>, size), radius_high = t.radius + error;
  if (!aabb_within(l, radius_high)) return verdict::miss;

  auto const is_separating = [&](vec3<T> const& g, T gg) {
    T const lowest =
        min(min(dot_mul_add(t.a, g), dot_mul_add(t.b, g)), dot_mul_add(t.c, g)) - max(dot_mul_add(l.path, g), T(0));
    return gg >= filter_bounds<T>::shortest && lowest > 0 &&
           mul_rn(lowest, lowest) > mul_rn(mul_rn(radius_high, radius_high), gg);
  };
  // for most, the direction to the middle of the prism separates
  vec3<T> const middle = (t.a + t.b + t.c) - scaled(l.path, T(1.5));
  if (is_separating(middle, dot_mul_add(middle, middle))) return verdict::miss;

  closest_approach<T> const closest = approach(l);
  T const v = saturate(closest.v), w = min(saturate(closest.w), T(1) - v), time = saturate(closest.time);
  auto const combined = [&](int k) { return t.a[k] + mul_add(v, t.b[k] - t.a[k], mul_rn(w, t.c[k] - t.a[k])); };
  vec3<T> const q = vec3<T>(combined(0), combined(1), combined(2)) - scaled(l.path, time);
  T const s = dot_mul_add(q, q);
  // decided on bits; not finite if some coordinate is not
  if (!is_finite(s) || !is_valid_radius(t.radius)) return verdict::uncertain;

  T const radius_low = t.radius - error;
  if (radius_low > 0 && s <= mul_rn(radius_low, radius_low)) return verdict::hit;

  if (is_separating(q, s)) return verdict::miss;
  vec3<T> n = closest.normal;  // has a smaller relative error than a short q
  if (dot_mul_add(n, q) < 0) n = -n;
  return is_separating(n, dot_mul_add(n, n)) ? verdict::miss : verdict::uncertain;
}

}  // namespace collide::detail
