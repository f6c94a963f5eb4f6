/// \file
/// The contact of a pair to all digits of a double, in numbers of twice as many.
///
/// Which foot is the closest point is decided in double, what is next to the boundary of two either way: the squared
/// distances of the two differ by the square of a rounding error only. The distance of that foot is then computed by
/// the formulas of exact/detail/predicates/exact.hpp. For what has too few digits all the same there is exact
/// arithmetic; see docs/development/numerics.md.
#pragma once

#include <limits>

#include <collide/exact/detail/geometry/closest_point.hpp>
#include <collide/exact/detail/numeric/double_double.hpp>

namespace collide::detail {

/// A triangle as seen from a sphere's centre, times a power of two, and its edges.
struct long_triangle {
  long_vector corner[3], edge[3];
};

/// (to - from) * scale.
COLLIDE_HD_INLINE long_vector long_difference(vec3<double> const& to, vec3<double> const& from, double scale) {
  return {scaled(exact_sum_of(to.x(), -from.x()), scale), scaled(exact_sum_of(to.y(), -from.y()), scale),
          scaled(exact_sum_of(to.z(), -from.z()), scale)};
}

/// The triangle as seen from where the sphere is at a time.
COLLIDE_HD inline long_triangle long_triangle_of(triangle<double> const& t, moving_sphere<double> const& s, double time,
                                                 double scale) {
  long_triangle l{
      {long_difference(t.a, s.centre, scale), long_difference(t.b, s.centre, scale),
       long_difference(t.c, s.centre, scale)},
      {long_difference(t.b, t.a, scale), long_difference(t.c, t.b, scale), long_difference(t.a, t.c, scale)}};
  if (time == 0) return l;
  vec3<double> const path = scaled(s.displacement, scale);
  for (long_vector& v : l.corner) {
    v.x = v.x - exact_product_of(path.x(), time);
    v.y = v.y - exact_product_of(path.y(), time);
    v.z = v.z - exact_product_of(path.z(), time);
  }
  return l;
}

/// The foot of the centre on a corner (0, 1, 2), an edge (3, 4, 5) or the face (6), and how far it is.
struct long_projection {
  int number;
  double_double distance;
  vec3<double> normal;  ///< from there to the centre, of any length
  double sine_squared;  ///< of an angle of the triangle, where the accuracy depends on it, else 1; 0: this is no foot
  bool certain;         ///< doubles leave no doubt of which feet there are
};

struct rounded_triangle {
  vec3<double> corner[3], edge[3];
  double length_squared[3];  ///< of the edges

  COLLIDE_HD_INLINE explicit rounded_triangle(long_triangle const& l) {
    COLLIDE_UNROLL
    for (int i = 0; i < 3; ++i) {
      corner[i] = l.corner[i].rounded();
      edge[i] = l.edge[i].rounded();
      length_squared[i] = dot(edge[i], edge[i]);
    }
  }
};

/// True if the centre projects into the face; then its foot. What is thinner than digits reach has no face.
COLLIDE_HD inline bool project_onto_face_compensated(long_triangle const& l, rounded_triangle const& r,
                                                     long_projection& found) {
  constexpr double error_squared = 0x1p-94;
  double const longest = max(max(r.length_squared[0], r.length_squared[1]), r.length_squared[2]);
  found.certain = true;
  if (!(longest > 0x1p-200)) return false;
  long_vector const n = cross(l.edge[0], l.edge[1]);
  vec3<double> const normal = n.rounded();
  double const nn = dot(normal, normal), sine_squared = div_rn(nn, mul_rn(longest, longest));
  if (!(sine_squared > 0x1p-180)) return false;
  bool inside = true, outside = false;
  COLLIDE_UNROLL
  for (int i = 0; i < 3; ++i) {
    double const side = dot(cross(r.corner[i], r.edge[i]), normal);
    bool const clear = mul_rn(side, side) > mul_rn(error_squared, mul_rn(r.length_squared[i], nn));
    inside = inside && side > 0;
    outside = outside || (clear && !(side > 0));
    found.certain = found.certain && clear;
  }
  if (sine_squared < 0x1p-80) {  // it cannot be told
    found.sine_squared = 0;
    return true;
  }
  if (!inside) {
    found.certain = outside;
    return false;
  }
  double_double const height = dot(l.corner[0], n), distance = height / root(dot(n, n));
  bool const above = height.high < 0;  // on the side that the normal points to
  found = {6, above ? -distance : distance, above ? normal : vec3<double>(-normal), sine_squared, found.certain};
  return true;
}

/// The nearest of the feet on corners and edges.
COLLIDE_HD inline void project_onto_boundary_compensated(long_triangle const& l, rounded_triangle const& r,
                                                         long_projection& found) {
  // guard: compensated-nearest
  constexpr double none = std::numeric_limits<double>::max(), error = 0x1p-43, error_squared = 0x1p-96;
  double square[6], lowest = none;
  COLLIDE_UNROLL
  for (int i = 0; i < 3; ++i) {
    vec3<double> const& v = r.corner[i];
    square[i] = dot(v, v);
    square[3 + i] = none;
    double const before = -dot(v, r.edge[i]), after = dot(r.corner[(i + 1) % 3], r.edge[i]);
    double const ee = r.length_squared[i], limit = mul_rn(error_squared, ee);
    if (ee > 0x1p-400) {
      bool const clear = mul_rn(before, before) > limit && mul_rn(after, after) > limit;
      found.certain = found.certain && clear;
      if (before > 0 && after > 0) {
        vec3<double> const c = cross(v, r.edge[i]);
        square[3 + i] = div_rn(dot(c, c), ee);
      }
    }
    lowest = min(lowest, min(square[i], square[3 + i]));
  }
  found = {-1, {none, 0}, {0, 0, 0}, 1, found.certain};
  COLLIDE_NO_UNROLL
  for (int projection = 0; projection < 6; ++projection) {
    if (!(square[projection] <= lowest + error)) continue;
    int const i = projection % 3;
    bool const is_corner = projection < 3;
    long_vector const c = is_corner ? l.corner[i] : cross(l.corner[i], l.edge[i]);
    double_double const cc = dot(c, c), there = is_corner ? cc : cc / dot(l.edge[i], l.edge[i]);
    if (found.number >= 0 && !(there < found.distance)) continue;
    found.number = projection;
    found.distance = there;
    found.normal = is_corner ? vec3<double>(-r.corner[i]) : cross(c.rounded(), r.edge[i]);
  }
  if (found.distance.high >= 0x1p-84) {
    found.distance = root(found.distance);
  } else {
    found.sine_squared = 0;
  }
}

/// radius - distance, rounded once except for the last bits.
COLLIDE_HD inline double depth_of(double radius, double_double const& distance) {
  if (radius >= 4 * distance.high) return radius - distance.high;
  double_double const depth = exact_sum_of(radius, -distance.high);
  return depth.high + (depth.low - distance.low);
}

/// Distance, normal and, if wanted, depth of a contact to nearly all digits of a double, and `closest`, the point of
/// the triangle as seen from where the sphere is at the time, times `scale`. The scaled triangle is in the range of
/// `to_unit_range`. False if that takes more digits than there are.
COLLIDE_HD_NOINLINE inline bool contact_compensated(triangle<double> const& t, moving_sphere<double> const& s,
                                                    double time, double scale, bool exact_depth, vec3<double>& closest,
                                                    contact_without_point& found) {
  // guard: compensated-scale
  if (!(scale >= 0x1p-1000 && scale <= 0x1p850)) return false;
  long_triangle const l = long_triangle_of(t, s, time, scale);
  rounded_triangle const r(l);
  long_projection nearest{};
  if (!project_onto_face_compensated(l, r, nearest)) project_onto_boundary_compensated(l, r, nearest);
  if (nearest.sine_squared == 0) return false;
  double const away = nearest.distance.high;
  double_double const distance = scaled(nearest.distance, div_rn(1.0, scale));
  double const depth = depth_of(s.radius, distance);
  // guard: compensated-depth
  double const lowest = exact_depth ? min(away, mul_rn(depth < 0 ? -depth : depth, scale)) : away;
  // guard: compensated-length
  if (!(mul_rn(mul_rn(lowest, lowest), nearest.sine_squared) >= 0x1p-84)) return false;
  // guard: compensated-doubt
  if (!nearest.certain && !(mul_rn(mul_rn(away, lowest), nearest.sine_squared) >= 0x1p-40)) return false;
  int const index = nearest.number % 3;
  vec3<double> const normal = unit(nearest.normal);
  closest = nearest.number < 3 ? r.corner[index] : scaled<double>(normal, -away);
  found = {{distance.high, depth},
           normal,
           nearest.number < 3 ? feature::vertex : (nearest.number < 6 ? feature::edge : feature::face),
           index};
  return true;
}

}  // namespace collide::detail
