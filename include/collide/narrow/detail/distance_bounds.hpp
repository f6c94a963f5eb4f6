/// \file
/// Bounds of the distance of a triangle from a point, in doubles: the filter of the search for the nearest triangle.
/// They hold whichever feature was found; docs/development/numerics.md ("The nearest triangle") derives the errors.
#pragma once

#include <collide/core/contact.hpp>
#include <collide/exact/detail/geometry/local_triangle.hpp>
#include <collide/exact/detail/predicates/exact_distance.hpp>
#include <collide/exact/detail/predicates/fixed_width_distance.hpp>

namespace collide::detail {

struct distance_bounds {
  double low, high;  ///< of the distance
  int foot;          ///< corners 0, 1 and 2, edges 3, 4 and 5, the face 6
  bool certain;      ///< the closest point is that foot
};

/// Corner `i`, from 0 to 2.
template <class S>
COLLIDE_HD_INLINE vec3<S> corner_of(triangle<S> const& t, int i) {
  return i == 0 ? t.a : (i == 1 ? t.b : t.c);
}

/// Equal numbers, decided on bits: subnormal numbers that are flushed to zero compare as if they were equal.
template <class S>
COLLIDE_HD_INLINE bool is_same_point(vec3<S> const& p, vec3<S> const& q) {
  bool same = true;
  COLLIDE_UNROLL
  for (int k = 0; k < 3; ++k) {
    auto const x = to_bits(p[k]), y = to_bits(q[k]);
    same = same & ((x == y) | (((x | y) & ~ieee_traits<S>::sign_mask) == 0));
  }
  return same;
}

/// Bounds of the distance of a finite triangle from a finite point. False if the triangle is farther than `reach`, with
/// nothing but `low` set.
template <class S>
COLLIDE_HD_INLINE bool bound_distance(triangle<S> const& t, vec3<S> const& point, double reach,
                                      distance_bounds& found) {
  constexpr double u = ieee_traits<double>::unit_roundoff, none = std::numeric_limits<double>::infinity();
  vec3<double> const a = difference_in_double(t.a, point), b = difference_in_double(t.b, point),
                     c = difference_in_double(t.c, point), ab = difference_in_double(t.b, t.a),
                     ac = difference_in_double(t.c, t.a);
  double const size = max(max(max_norm(a), max_norm(b)), max_norm(c));
  // flushed numbers of S are below u M and u L, and no product of six numbers is out of range
  constexpr double smallest = sizeof(S) == sizeof(float) ? 0x1p-70 : 0x1p-120, largest = 0x1p140;
  double const length = max(max(max_norm(ab), max_norm(ac)), smallest);
  // guard: bounds-smallest
  if (!(size >= smallest && size <= largest)) {
    found = {0, size <= largest ? mul_rn(2.0, size) + 2 * smallest : none, 6, false};
    return true;
  }
  double const d1 = -dot_mul_add(ab, a), d2 = -dot_mul_add(ac, a), d3 = -dot_mul_add(ab, b), d4 = -dot_mul_add(ac, b),
               d5 = -dot_mul_add(ab, c), d6 = -dot_mul_add(ac, c);
  auto const minor = [](double p, double q, double r, double s) { return mul_add(p, q, -mul_rn(r, s)); };
  double const va = minor(d3, d6, d5, d4), vb = minor(d5, d2, d1, d6), vc = minor(d1, d4, d3, d2);
  double const e = mul_rn(16 * u, mul_rn(length, size)), f = mul_rn(mul_rn(e, 16.0), mul_rn(length, size));
  // C. Ericson, Real-Time Collision Detection, 5.1.5
  double v = vb, w = vc, sum = va + vb + vc;
  int foot = 6;
  bool certain = (va > f) & (vb > f) & (vc > f);
  auto const region = [&](bool inside, bool surely, int number, double v_there, double w_there, double sum_there) {
    v = inside ? v_there : v;
    w = inside ? w_there : w;
    sum = inside ? sum_there : sum;
    foot = inside ? number : foot;
    // guard: bounds-certain
    certain = inside ? surely : certain;
  };
  double const from_b = d4 - d3, from_c = d5 - d6;
  region((va <= 0) & (from_b >= 0) & (from_c >= 0), (va < -f) & (from_b > 4 * e) & (from_c > 4 * e), 4, from_c, from_b,
         from_b + from_c);
  region((vb <= 0) & (d2 >= 0) & (d6 <= 0), (vb < -f) & (d2 > e) & (d6 < -e), 5, 0, d2, d2 - d6);
  region((vc <= 0) & (d1 >= 0) & (d3 <= 0), (vc < -f) & (d1 > e) & (d3 < -e), 3, d1, 0, d1 - d3);
  region((d6 >= 0) & (d5 <= d6), (d6 > e) & (from_c < -4 * e), 2, 0, 1, 1);
  region((d3 >= 0) & (d4 <= d3), (d3 > e) & (from_b < -4 * e), 1, 1, 0, 1);
  region((d1 <= 0) & (d2 <= 0), (d1 < -e) & (d2 < -e), 0, 0, 0, 1);
  double const inverse = sum > 0 ? div_rn(1.0, sum) : 0;
  v = saturate(mul_rn(v, inverse));
  w = min(saturate(mul_rn(w, inverse)), 1 - v);
  auto const combined = [&](int k) { return a[k] + mul_add(v, ab[k], mul_rn(w, ac[k])); };
  vec3<double> const q = {combined(0), combined(1), combined(2)};
  if (foot < 3 && is_same_point(point, corner_of(t, foot))) {
    found = {0, 0, foot, true};
    return true;
  }
  // guard: bounds
  double const error = mul_rn(64 * u, size), beyond = reach + error;
  found.low = 0;
  auto const is_separating = [&](vec3<double> const& g) {
    double const gg = dot_mul_add(g, g), along = min(min(dot_mul_add(a, g), dot_mul_add(b, g)), dot_mul_add(c, g));
    // guard: bounds-least
    if (!(along > 0) || !(gg > 0x1p-600)) return false;
    if (mul_rn(along, along) > mul_rn(mul_rn(beyond, beyond), gg)) return true;
    found.low = max(found.low, div_rn(along, sqrt_rn(gg)) - error);
    return false;
  };
  if (is_separating(q)) return false;
  if (foot == 6 || !certain) {  // close to the plane, its normal has a smaller relative error than q
    vec3<double> const n = cross(ab, ac);
    if (is_separating(dot_mul_add(a, n) < 0 ? vec3<double>(-n) : n)) return false;
  }
  found.high = sqrt_rn(dot_mul_add(q, q)) + error;
  found.foot = foot;
  found.certain = certain;
  return true;
}

/// The foot of a finite point on a finite triangle, exactly: corners 0, 1 and 2, edges 3, 4 and 5, the face 6.
COLLIDE_HD_NOINLINE inline int closest_foot(triangle<double> const& t, vec3<double> const& point) {
  fixed_width_units units;
  units.include(point);
  units.include(t);
  return units.fit() ? fixed_width_distance(units, t, point).projection() : closest_foot_in_integers(t, point);
}

/// -1 if the point is nearer to s than to t, 0 if it is as near, else 1: exactly. Finite coordinates.
COLLIDE_HD_NOINLINE inline int compare_distances(triangle<double> const& s, triangle<double> const& t,
                                                 vec3<double> const& point) {
  fixed_width_units units;
  units.include(point);
  units.include(s);
  units.include(t);
  if (!units.fit()) return compare_distances_in_integers(s, t, point);
  return fixed_width_distance::compare(fixed_width_distance(units, s, point), fixed_width_distance(units, t, point));
}

template <class S>
COLLIDE_HD_NOINLINE int compare_distances(triangle<S> const& s, triangle<S> const& t, vec3<S> const& point) {
  return compare_distances(widened(s), widened(t), widened(point));
}

/// True if both feet are one corner, or one edge: then both triangles are as near.
template <class S>
COLLIDE_HD_INLINE bool is_same_foot(triangle<S> const& s, int foot_of_s, triangle<S> const& t, int foot_of_t) {
  if (foot_of_s < 3) return foot_of_t < 3 && is_same_point(corner_of(s, foot_of_s), corner_of(t, foot_of_t));
  if (foot_of_s == 6 || foot_of_t < 3 || foot_of_t == 6) return false;
  vec3<S> const p = corner_of(s, foot_of_s % 3), q = corner_of(s, (foot_of_s + 1) % 3), u = corner_of(t, foot_of_t % 3),
                v = corner_of(t, (foot_of_t + 1) % 3);
  return (is_same_point(p, v) && is_same_point(q, u)) || (is_same_point(p, u) && is_same_point(q, v));
}

}  // namespace collide::detail
