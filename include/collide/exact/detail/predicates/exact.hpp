/// \file
/// A sphere and a triangle in exact arithmetic: the last stage of the predicate, and depths without cancellation.
///
/// The closest point of a triangle is a corner, or the projection of a perpendicular inside an edge or inside the face.
/// The sphere touches the triangle if and only if one of these, where there is such a projection, is within the radius.
/// With everything relative to the centre, and so a corner v, an edge e from v, and the normal n:
///
///                projection is inside if                       squared distance
///     corner                                             v.v
///     edge       -v.e > 0 and (v + e).e > 0              |v x e|^2 / e.e
///     face       (v x e).n > 0 for all three edges       (v.n)^2 / n.n
///
/// All of these are sums of products of at most six numbers of a table.
///
/// It runs for two pairs in a million, so it is there once, for doubles, and small: floats are widened.
#pragma once

#include <collide/exact/detail/geometry/closest_point.hpp>
#include <collide/exact/detail/numeric/exact_sum.hpp>

namespace collide::detail {

/// Places of the numbers of a triangle and a sphere in their table. Vectors have three numbers; there are three
/// corners and three edges.
struct exact_slot {
  enum : int {
    corner = 0,  ///< relative to the centre
    edge = 9,    ///< from each corner to the next
    radius = 18,
    end = 19
  };
  using memory = exact_memory<9 * 4 + 9 * 2 + 1, end>;
};

/// Adds the corners as seen from a centre that moves, when it is where it is at a time of at most 53 bits.
COLLIDE_HD_NOINLINE inline void add_corners(exact_numbers& table, triangle<double> const& t,
                                            moving_sphere<double> const& s, dyadic time) {
  for (int i = 0; i < 9; ++i) {
    int const k = i % 3;
    table.begin_number();
    table.add(decoded((i < 3 ? t.a : (i < 6 ? t.b : t.c))[k]));
    table.subtract(decoded(s.centre[k]));
    table.add_product(decoded(-s.displacement[k]), time);
  }
}

/// Adds the edges, from each corner to the next.
COLLIDE_HD_NOINLINE inline void add_edges(exact_numbers& table, triangle<double> const& t) {
  for (int i = 0; i < 9; ++i) {
    int const k = i % 3;
    table.begin_number();
    table.add(decoded((i < 3 ? t.b : (i < 6 ? t.c : t.a))[k]));
    table.subtract(decoded((i < 3 ? t.a : (i < 6 ? t.b : t.c))[k]));
  }
}

/// Fills the table for a sphere where it is at that time. Finite coordinates and a finite radius, not below 0.
COLLIDE_HD_NOINLINE inline exact_numbers exact_numbers_of(exact_numbers table, triangle<double> const& t,
                                                          moving_sphere<double> const& s, dyadic time) {
  add_corners(table, t, s, time);
  add_edges(table, t);
  table.begin_number();
  table.add(decoded(s.radius));
  return table;
}

/// x * 2^n, also where 2^n is beyond the range.
COLLIDE_HD inline double times_power(double x, int n) {
  for (; n > 1000; n -= 1000) x *= 0x1p1000;
  // guard: power-below
  for (; n < -1000; n += 1000) x *= 0x1p-1000;
  return x * from_bits<double>(static_cast<std::uint64_t>(n + 1023) << 52);
}

/// Formulas on the numbers of a table, which must outlive this. Feet have numbers: corners 0, 1 and 2, edges 3, 4 and
/// 5, the face 6.
class exact_triangle {
 public:
  /// `corners` and `edges` are the places of the first ones.
  COLLIDE_HD explicit exact_triangle(exact_numbers const& numbers, int corners = exact_slot::corner,
                                     int edges = exact_slot::edge)
      : numbers_(numbers), corners_(corners), edges_(edges) {}

  static COLLIDE_HD feature feature_of(int projection) {
    return projection < 3 ? feature::vertex : (projection < 6 ? feature::edge : feature::face);
  }
  /// Which corner or edge it is.
  static COLLIDE_HD int feature_index_of(int projection) { return projection % 3; }

  COLLIDE_HD bool intersects() const {
    for (int projection = 0; projection < projections; ++projection) {
      // guard: touching
      if (exists(projection) && excess(projection, false).value >= 0) return true;
    }
    return false;
  }

  /// The projection that is the closest point, by signs alone: the face or an edge if the centre projects into its
  /// interior, else a corner.
  COLLIDE_HD int closest_foot() const {
    if (exists(face)) return face;
    for (int i = 0; i < 3; ++i) {
      if (exists(3 + i) && side_of_edge(i) <= 0) return 3 + i;
    }
    int i = 0;
    while (i < 2 && !(along(i, i, -1) <= 0 && along((i + 2) % 3, i, 1) <= 0)) ++i;
    return i;
  }

  /// The square of the distance of a projection is a quotient of two sums of products. This is the denominator: the
  /// squared length of the edge or of the normal, or 1.
  COLLIDE_HD void add_length(exact_products& sum, int projection) const {
    int const e = edge(feature_index_of(projection));
    if (projection < 3) {
      sum.add(1);
    } else if (projection < face) {
      add_dot(sum, 1, e, e);
    } else {
      add_cross_squared(sum, 1, e, edge(1));
    }
  }

  /// The numerator of that quotient.
  COLLIDE_HD void add_distance_squared(exact_products& sum, int weight, int projection) const {
    int const v = corner(feature_index_of(projection)), e = edge(feature_index_of(projection));
    if (projection < 3) {
      add_dot(sum, weight, v, v);
    } else if (projection < face) {
      add_cross_squared(sum, weight, v, e);
    } else {
      add_determinant_squared(sum, weight, v, e, edge(1));
    }
  }

  /// The denominator, and the numerator, as numbers.
  COLLIDE_HD_NOINLINE scaled_double length(int projection) const {
    exact_products sum;
    add_length(sum, projection);
    return exact_sum::of(numbers_, sum);
  }
  COLLIDE_HD_NOINLINE scaled_double distance_squared(int projection) const {
    exact_products sum;
    add_distance_squared(sum, 1, projection);
    return exact_sum::of(numbers_, sum);
  }

  /// How far along edge i the centre projects, multiplied by the `length` of the edge.
  COLLIDE_HD_NOINLINE scaled_double place_on_edge(int i) const {
    exact_products sum;
    add_dot(sum, -1, corner(i), edge(i));
    return exact_sum::of(numbers_, sum);
  }
  /// The weight, at the projection on the face, of the corner that is opposite edge i, multiplied by the `length` of
  /// the face.
  COLLIDE_HD_NOINLINE scaled_double weight_against_edge(int i) const {
    exact_products sum;
    add_cross_dot_cross(sum, corner(i), edge(i), edge(0), edge(1));
    return exact_sum::of(numbers_, sum);
  }

  /// The projection that is the closest point, and how it lies to the sphere. `l` is the same triangle in doubles,
  /// `normalised`, and `around` the square of its distance.
  COLLIDE_HD int nearest(local_triangle<double> const& l, double around, separation& to_nearest) const {
    int best = 0, found = 0;
    for (unsigned wanted = candidate_feet(l, around); found == 0; wanted = all_feet) {
      for (int projection = 0; projection < projections; ++projection) {
        if ((wanted >> projection & 1) == 0 || !exists(projection)) continue;
        separation const there = measured(projection);
        // each of the two has all its digits where it is the smaller one
        // guard: equally-deep
        bool const nearer =
            there.depth > there.distance ? there.distance < to_nearest.distance : there.depth > to_nearest.depth;
        if (found++ == 0 || nearer) {
          best = projection;
          to_nearest = there;
        }
      }
    }
    return best;
  }

  /// From the projection to the centre, except for the length; 0 if the centre is there.
  COLLIDE_HD vec3<double> direction_to_centre(int projection) const {
    if (projection != face) return direction(projection);
    double const height = sign_of_height();
    return normal() * -height;
  }

  /// (b - a) x (c - a), except for its length.
  COLLIDE_HD vec3<double> normal() const { return direction(face); }

 private:
  static constexpr int projections = 7, face = 6;
  static constexpr unsigned all_feet = 0x7f;  ///< a bit for each

  exact_numbers numbers_;
  int corners_, edges_;

  COLLIDE_HD int corner(int i) const { return corners_ + 3 * i; }
  COLLIDE_HD int edge(int i) const { return edges_ + 3 * i; }

  // Each formula has its list of products in a function of its own, out of line, so that there is memory for one.

  /// The centre projects into the edge or the face.
  COLLIDE_HD bool exists(int projection) const {
    if (projection < 3) return true;
    // guard: edge-begin, edge-end
    if (projection < face)
      return along(projection - 3, projection - 3, -1) > 0 && along(projection - 3, (projection + 1) % 3, 1) > 0;
    for (int i = 0; i < 3; ++i) {
      // guard: over-face
      if (side_of_edge(i) <= 0) return false;
    }
    return true;
  }

  /// The sign of a corner's place along an edge.
  COLLIDE_HD_NOINLINE int along(int i, int from, int weight) const {
    exact_products distance_along;
    add_dot(distance_along, weight, corner(from), edge(i));
    return exact_sum::sign_of(numbers_, distance_along);
  }

  /// On which side of the edge the centre projects: above 0 if on that of the face.
  COLLIDE_HD_NOINLINE int side_of_edge(int i) const {
    exact_products side;
    add_cross_dot_cross(side, corner(i), edge(i), edge(0), edge(1));
    return exact_sum::sign_of(numbers_, side);
  }

  /// On which side of the face the centre is.
  COLLIDE_HD_NOINLINE int sign_of_height() const {
    exact_products height;
    add_determinant(height, 1, corner(0), edge(0), edge(1));
    return exact_sum::sign_of(numbers_, height);
  }

  /// The square of the radius less that of the distance, multiplied by `length`; or only a number of its sign.
  COLLIDE_HD_NOINLINE scaled_double excess(int projection, bool with_value) const {
    exact_products sum;
    add_length(sum, projection);
    sum.multiply_by(exact_slot::radius);
    sum.multiply_by(exact_slot::radius);
    add_distance_squared(sum, -1, projection);
    return exact_sum::of(numbers_, sum, with_value);
  }

  /// The errors are a few units in the last place, however small the numbers are.
  COLLIDE_HD separation measured(int projection) const {
    scaled_double const by = length(projection), d = root_of_distance_squared(projection, by);
    double const distance = times_power(d.value, d.exponent);
    scaled_double const above = excess(projection, true);
    // guard: depth-of-a-tie
    if (above.value == 0) return {distance, 0};
    // R - d = (R^2 - d^2) / (R + d), where R and d are divided by a power of two as large as the larger one
    components_view const radius = numbers_[exact_slot::radius];
    dyadic const r = radius.count == 0 ? dyadic{0, 0} : radius[0];
    int const top = r.mantissa == 0 ? d.exponent : max(d.exponent, r.exponent + r.length());
    double const sum =
        times_power(static_cast<double>(r.mantissa), r.exponent - top) + times_power(d.value, d.exponent - top);
    double const depth = times_power(div_rn(div_rn(above.value, by.value), sum), above.exponent - by.exponent - top);
    double const whole = times_power(static_cast<double>(r.mantissa), r.exponent);
    return {distance, min(depth, whole)};  // rounding up from the largest number would make it infinite
  }

  /// The distance, if `by` is the denominator: a value between 1/2 and 2, or 0, times a power of two; that of 0 is
  /// below all others.
  COLLIDE_HD scaled_double root_of_distance_squared(int projection, scaled_double const& by) const {
    scaled_double const square = distance_squared(projection);
    if (square.value == 0) return {0, -4000};
    int const exponent = square.exponent - by.exponent, half = exponent / 2;
    return {sqrt_rn(times_power(div_rn(square.value, by.value), exponent - 2 * half)), half};
  }

  /// The projections that are not certainly farther than the root of `around`, as far as doubles can tell.
  static COLLIDE_HD unsigned candidate_feet(local_triangle<double> const& l, double around) {
    // guard: near-feet
    double const reach = sqrt_rn(around) + 0x1p-40, limit = mul_rn(mul_rn(reach, reach), 1 + 0x1p-40);  // l is below 4
    vec3<double> const v[3] = {l.a, l.b, l.c};
    unsigned candidates = 1u << face;
    for (int i = 0; i < 3; ++i) {
      vec3<double> const e = v[(i + 1) % 3] - v[i], c = detail::cross(v[i], e);
      double const ee = dot(e, e);
      if (dot(v[i], v[i]) <= limit) candidates |= 1u << i;
      if (dot(c, c) <= mul_rn(limit, ee)) candidates |= 8u << i;
    }
    return candidates;
  }

  /// From a corner or an edge to the centre, or the normal of the face; except for the length.
  COLLIDE_HD vec3<double> direction(int projection) const {
    scaled_double w[3];
    int top = -(1 << 30);
    for (int k = 0; k < 3; ++k) {
      w[k] = component_of_direction(projection, k);
      if (w[k].value != 0) top = max(top, w[k].exponent);
    }
    vec3<double> d;
    for (int k = 0; k < 3; ++k) {
      d[k] = w[k].value == 0 ? 0 : times_power(w[k].value, max(w[k].exponent - top, -2000));
    }
    return d;
  }

  COLLIDE_HD_NOINLINE scaled_double component_of_direction(int projection, int k) const {
    exact_products sum;
    int const v = corner(feature_index_of(projection)), e = edge(feature_index_of(projection));
    if (projection < 3) {
      sum.add(-1, v + k);
    } else if (projection < face) {
      for (int i = 0; i < 3; ++i) {  // e (v.e) - v (e.e)
        sum.add(1, e + k, v + i, e + i);
        sum.add(-1, v + k, e + i, e + i);
      }
    } else {
      add_cross(sum, 1, k, edge(0), edge(1));
    }
    return exact_sum::of(numbers_, sum);
  }
};

/// True if the sphere touches the triangle. Finite coordinates and a finite radius, not below 0.
COLLIDE_HD_NOINLINE inline bool intersects_in_integers(triangle<double> const& t, sphere<double> const& s) {
  exact_slot::memory memory;
  return exact_triangle(exact_numbers_of(memory.table(), t, {s, {0, 0, 0}}, {0, 0})).intersects();
}

}  // namespace collide::detail
