/// \file
/// The closest point of a triangle and its distance, to all digits, once it is known which foot it is.
///
/// In numbers of twice the digits of a double where these suffice, else exactly: 2^-56 bounds the relative error of the
/// distance before it is rounded.
#pragma once

#include <collide/exact/detail/predicates/exact_distance.hpp>
#include <collide/narrow/detail/contact_compensated.hpp>

namespace collide::detail {

struct measured_foot {
  double distance;
  double_double weight[3];  ///< of the corners
  vec3<double> direction;   ///< from there to the point, except for the length; on the triangle its normal, or 0
};

/// The sum of both, as a number that is scaled.
COLLIDE_HD_INLINE double_double digits_of_scaled(scaled_double const& x) { return {x.value, x.rest}; }

/// x / y as it is, between 0 and 1.
COLLIDE_HD inline double_double fraction_of(scaled_double const& x, scaled_double const& y) {
  if (x.value == 0) return {0, 0};
  double_double const q = digits_of_scaled(x) / digits_of_scaled(y);
  int const exponent = x.exponent - y.exponent;
  return {times_power(q.high, exponent), times_power(q.low, exponent)};
}

/// The weights of an edge or a face from those that are known.
COLLIDE_HD inline void set_weights(measured_foot& found, int foot, double_double const& first,
                                   double_double const& second) {
  double_double const one{1, 0};
  int const i = foot % 3, next = (i + 1) % 3, last = (i + 2) % 3;
  for (auto& w : found.weight) w = {0, 0};
  if (foot < 3) {
    found.weight[i] = one;
  } else if (foot < 6) {
    found.weight[next] = first;
    found.weight[i] = one - first;
  } else {
    found.weight[next] = first;
    found.weight[last] = second;
    found.weight[i] = one - (first + second);
  }
}

COLLIDE_HD_NOINLINE inline measured_foot measure_foot_exactly(triangle<double> const& t, vec3<double> const& point,
                                                              int foot) {
  exact_slot::memory memory;
  exact_triangle const e(exact_numbers_of(memory.table(), t, resting_at(point), {0, 0}));
  measured_foot found{};
  scaled_double const by = e.length(foot), square = e.distance_squared(foot);
  if (square.value != 0) {
    int const exponent = square.exponent - by.exponent, half = exponent / 2;
    double_double const quotient = digits_of_scaled(square) / digits_of_scaled(by);
    found.distance = times_power(root(scaled(quotient, times_power(1, exponent - 2 * half))).high, half);
    found.distance = max(found.distance, std::numeric_limits<double>::denorm_min());  // 0 only on the triangle
  }
  if (foot < 3) {
    set_weights(found, foot, {}, {});
  } else if (foot < 6) {
    set_weights(found, foot, fraction_of(e.place_on_edge(foot - 3), by), {});
  } else {
    set_weights(found, foot, fraction_of(e.weight_against_edge(2), by), fraction_of(e.weight_against_edge(0), by));
  }
  found.direction = e.direction_to_centre(foot);
  if (max_norm(found.direction) == 0) found.direction = e.normal();
  return found;
}

/// True if a triangle and a point lie in a plane across an axis, as many faces of buildings and machines do.
COLLIDE_HD_INLINE bool is_level(triangle<double> const& t, vec3<double> const& point) {
  bool level = false;
  // guard: measured-level
  for (int k = 0; k < 3; ++k) level = level || (t.a[k] == point[k] && t.b[k] == point[k] && t.c[k] == point[k]);
  return level;
}

/// The foot in numbers of twice the digits. False if these do not suffice.
COLLIDE_HD inline bool measure_foot_compensated(triangle<double> const& t, vec3<double> const& point, int foot,
                                                measured_foot& found) {
  constexpr double smallest = 0x1p-88;  // of a square: half of the digits, and 2^-56 left of the rest
  sphere<double> const centre{point, 0};
  double const scale = to_unit_range(to_local<double>(t, centre), t, centre).scale;
  // guard: measured-scale
  if (!(scale >= 0x1p-1000 && scale <= 0x1p850)) return false;
  long_triangle const l = long_triangle_of(t, resting_at(point), 0, scale);
  rounded_triangle const r(l);
  int const i = foot % 3;
  double_double distance;
  if (foot < 3) {
    double_double const square = dot(l.corner[i], l.corner[i]);
    if (!(square.high >= 0x1p-200)) return false;
    distance = root(square);
    found.direction = -r.corner[i];
    set_weights(found, foot, {}, {});
  } else if (foot < 6) {
    long_vector const c = cross(l.corner[i], l.edge[i]);
    double_double const square = dot(c, c), by = dot(l.edge[i], l.edge[i]);
    double const limit = mul_rn(smallest, max(dot(r.corner[i], r.corner[i]), 1.0));
    // guard: measured-edge
    if (!(by.high >= limit && square.high >= mul_rn(limit, by.high))) return false;
    distance = root(square / by);
    found.direction = cross(c.rounded(), r.edge[i]);
    set_weights(found, foot, -dot(l.corner[i], l.edge[i]) / by, {});
  } else {
    long_vector const n = cross(l.edge[0], l.edge[1]);
    double_double const height = dot(l.corner[0], n), by = dot(n, n);
    double const longest = max(max(r.length_squared[0], r.length_squared[1]), r.length_squared[2]);
    double const limit = mul_rn(mul_rn(smallest, 64.0), mul_rn(longest, longest));
    // guard: measured-face
    bool const is_on = is_level(t, point);
    if (!(longest >= 0x1p-160 && by.high >= mul_rn(smallest * 64, longest) &&
          (is_on || mul_rn(height.high, height.high) >= limit)))
      return false;
    distance = is_on ? double_double{0, 0} : height / root(by);
    bool const above = is_on || distance.high < 0;  // on the side that the normal points to
    if (distance.high < 0) distance = -distance;
    found.direction = above ? n.rounded() : vec3<double>(-n.rounded());
    set_weights(found, foot, dot(cross(l.corner[2], l.edge[2]), n) / by, dot(cross(l.corner[0], l.edge[0]), n) / by);
  }
  found.distance = div_rn(distance.high, scale);
  return true;
}

/// A foot that is known to be the closest point.
COLLIDE_HD_NOINLINE inline measured_foot measure_foot(triangle<double> const& t, vec3<double> const& point, int foot) {
  measured_foot found;
  if (!measure_foot_compensated(t, point, foot, found)) found = measure_foot_exactly(t, point, foot);
  return found;
}

/// The point with these weights, rounded once except for the last bits.
COLLIDE_HD inline vec3<double> point_of_weights(triangle<double> const& t, double_double const (&weight)[3]) {
  vec3<double> point;
  for (int k = 0; k < 3; ++k) {
    double const a = t.a[k], b = t.b[k], c = t.c[k];
    double const size = max(max(max(a, -a), max(b, -b)), max(c, -c));
    if (size > 0x1p-900 && size < 0x1p900) {  // else parts of products would under- or overflow
      double_double const sum =
          double_double{a, 0} * weight[0] + double_double{b, 0} * weight[1] + double_double{c, 0} * weight[2];
      point[k] = sum.high;
    } else {
      point[k] = mul_rn(a, weight[0].high) + mul_rn(b, weight[1].high) + mul_rn(c, weight[2].high);
    }
  }
  return point;
}

}  // namespace collide::detail
