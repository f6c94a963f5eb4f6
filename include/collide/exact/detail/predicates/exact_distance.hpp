/// \file
/// Which of two triangles is nearer to a point, and which feature of one is closest, in exact arithmetic.
///
/// The square of a distance is a quotient of sums of products; see exact.hpp. Quotients are compared crosswise:
/// products of at most ten numbers of a table.
#pragma once

#include <collide/exact/detail/predicates/exact.hpp>

namespace collide::detail {

/// Places of the numbers of a second triangle in the table: after those of `exact_slot`.
struct exact_second_slot {
  enum : int {
    corner = exact_slot::end,  ///< relative to the point
    edge = corner + 9,         ///< from each corner to the next
    end = edge + 9
  };
  using memory = exact_memory<2 * (9 * 2 + 9 * 2) + 1, end>;
};

/// A point as a sphere that takes no room.
COLLIDE_HD inline moving_sphere<double> resting_at(vec3<double> const& point) { return {{point, 0}, {0, 0, 0}}; }

/// The projection of a point on a finite triangle: corners 0, 1 and 2, edges 3, 4 and 5, the face 6.
COLLIDE_HD_NOINLINE inline int closest_foot_in_integers(triangle<double> const& t, vec3<double> const& point) {
  exact_slot::memory memory;
  return exact_triangle(exact_numbers_of(memory.table(), t, resting_at(point), {0, 0})).closest_foot();
}

/// -1 or 1: the sign of a * b - c * d, none of them negative; 0 if that takes more digits than these numbers have.
COLLIDE_HD inline int compare_roughly(scaled_double const& a, scaled_double const& b, scaled_double const& c,
                                      scaled_double const& d) {
  double const left = mul_rn(mul_rn(a.value, 0x1p-64), mul_rn(b.value, 0x1p-64)),
               right = mul_rn(mul_rn(c.value, 0x1p-64), mul_rn(d.value, 0x1p-64));
  if (left == 0 || right == 0) return left > right ? 1 : (left < right ? -1 : 0);
  int const shift = max(-100, min(100, a.exponent + b.exponent - c.exponent - d.exponent));
  // guard: nearest-rough
  double const shifted = times_power(left, shift), difference = shifted - right, error = mul_rn(right, 0x1p-48);
  return difference > error ? 1 : (difference < -error ? -1 : 0);
}

/// -1 if the point is nearer to s than to t, 0 if it is as near, else 1. Finite coordinates.
COLLIDE_HD_NOINLINE inline int compare_distances_in_integers(triangle<double> const& s, triangle<double> const& t,
                                                             vec3<double> const& point) {
  exact_second_slot::memory memory;
  exact_numbers numbers = exact_numbers_of(memory.table(), s, resting_at(point), {0, 0});
  add_corners(numbers, t, resting_at(point), {0, 0});
  add_edges(numbers, t);
  exact_triangle const of_s(numbers), of_t(numbers, exact_second_slot::corner, exact_second_slot::edge);
  int const foot_of_s = of_s.closest_foot(), foot_of_t = of_t.closest_foot();
  int const rough = compare_roughly(of_s.distance_squared(foot_of_s), of_t.length(foot_of_t),
                                    of_t.distance_squared(foot_of_t), of_s.length(foot_of_s));
  if (rough != 0) return rough;
  exact_products square_of_s, length_of_s, square_of_t, length_of_t;
  of_s.add_distance_squared(square_of_s, 1, foot_of_s);
  of_s.add_length(length_of_s, foot_of_s);
  of_t.add_distance_squared(square_of_t, 1, foot_of_t);
  of_t.add_length(length_of_t, foot_of_t);
  return exact_sum::sign_of(numbers, difference_of_products(square_of_s, length_of_t, square_of_t, length_of_s));
}

}  // namespace collide::detail
