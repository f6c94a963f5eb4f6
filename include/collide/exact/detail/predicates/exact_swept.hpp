/// \file
/// A moving sphere and a triangle in exact arithmetic.
///
/// The way of the centre and the triangle are closest where one of these is the case:
///   - the way begins or ends, and there the triangle is closest: see exact.hpp;
///   - the way goes through the triangle;
///   - the projection of a corner lies inside the way;
///   - the common perpendicular of way and edge has its projections inside of both.
/// The sphere touches the triangle if and only if one of these, where it exists, is within the radius. With the way d,
/// a corner v and the next v' as seen from the beginning and w from the end, the edge e from v to v', the normal n of
/// the triangle, and m = d x e:
///
///                it exists if                                                          squared distance
///     through    v.n and w.n differ in sign, all three d.(v x e) do not                0
///     corner     v.d > 0 and w.d < 0                                                   |v x d|^2 / d.d
///     edge       (v x e).m > 0, (w x e).m < 0, (v x d).m > 0 and (v' x d).m < 0        (v.m)^2 / m.m
///
/// All of these are sums of products of at most six factors. Where something is parallel or zero, the distance is
/// found at another of these places.
#pragma once

#include <collide/exact/detail/predicates/exact.hpp>

namespace collide::detail {

/// Places of the further numbers of a sweep in the table. Those of `exact_slot` are as seen from the end of the path.
struct exact_sweep_slot {
  enum : int {
    path = exact_slot::end,   ///< from the beginning of the way to its end
    first_corner = path + 3,  ///< relative to the beginning
    end = first_corner + 9
  };
  using memory = exact_memory<9 * 4 + 9 * 2 + 1 + 3 * 2 + 9 * 2, end>;
};

/// Fills the table for the way of a sphere until a time.
COLLIDE_HD_NOINLINE inline exact_numbers exact_sweep_of(exact_numbers table, triangle<double> const& t,
                                                        moving_sphere<double> const& s, dyadic time) {
  table = exact_numbers_of(table, t, s, time);
  for (int k = 0; k < 3; ++k) {
    table.begin_number();
    table.add_product(decoded(s.displacement[k]), time);
  }
  add_corners(table, t, s, {0, 0});
  return table;
}

/// Formulas on the numbers of a table, whose memory must outlive this.
class exact_sweep {
 public:
  COLLIDE_HD explicit exact_sweep(exact_numbers const& numbers) : numbers_(numbers) {}

  /// True if the sphere touches the triangle until the time that the table was made for.
  COLLIDE_HD bool intersects() const {
    int const seen_from[2] = {start(0), end(0)};
    for (int const corners : seen_from) {
      if (exact_triangle(numbers_, corners).intersects()) return true;
    }
    if (crosses_face()) return true;
    for (int i = 0; i < 3; ++i) {
      if ((passes_vertex(i) && vertex_within_radius(i)) || (passes_edge(i) && edge_within_radius(i))) return true;
    }
    return false;
  }

 private:
  static constexpr int path = exact_sweep_slot::path;

  exact_numbers numbers_;

  /// A corner as seen from the beginning, and from the end.
  static COLLIDE_HD int start(int i) { return exact_sweep_slot::first_corner + 3 * i; }
  static COLLIDE_HD int end(int i) { return exact_slot::corner + 3 * i; }
  static COLLIDE_HD int edge(int i) { return exact_slot::edge + 3 * i; }

  COLLIDE_HD int sign(exact_products const& sum) const { return exact_sum::sign_of(numbers_, sum); }

  // Each formula is out of line, as in exact_triangle.

  COLLIDE_HD_NOINLINE int sign_of_determinant(int v, int p, int q) const {
    exact_products sum;
    add_determinant(sum, 1, v, p, q);
    return sign(sum);
  }

  COLLIDE_HD bool crosses_face() const {
    int const before = sign_of_determinant(start(0), edge(0), edge(1));
    if (before == 0 || sign_of_determinant(end(0), edge(0), edge(1)) != -before) return false;
    int const side = edge_side(0);
    return side != 0 && edge_side(1) == side && edge_side(2) == side;
  }

  /// On which side the line of the way passes the edge.
  COLLIDE_HD int edge_side(int i) const { return sign_of_determinant(path, start(i), edge(i)); }

  COLLIDE_HD bool passes_vertex(int i) const { return along_path(start(i)) > 0 && along_path(end(i)) < 0; }

  COLLIDE_HD_NOINLINE int along_path(int v) const {
    exact_products sum;
    add_dot(sum, 1, v, path);
    return sign(sum);
  }

  COLLIDE_HD_NOINLINE bool vertex_within_radius(int i) const {
    exact_products excess;
    add_dot(excess, 1, path, path);
    times_square_of_radius(excess);
    add_cross_squared(excess, -1, start(i), path);
    return sign(excess) >= 0;
  }

  COLLIDE_HD bool passes_edge(int i) const {
    int const e = edge(i);
    return side(start(i), e, e) > 0 && side(end(i), e, e) < 0 && side(start(i), path, e) > 0 &&
           side(start((i + 1) % 3), path, e) < 0;
  }

  /// The sign of (v x along).(d x e).
  COLLIDE_HD_NOINLINE int side(int v, int along, int e) const {
    exact_products sum;
    add_cross_dot_cross(sum, v, along, path, e);
    return sign(sum);
  }

  COLLIDE_HD_NOINLINE bool edge_within_radius(int i) const {
    exact_products excess;
    add_cross_squared(excess, 1, path, edge(i));
    times_square_of_radius(excess);
    add_determinant_squared(excess, -1, start(i), path, edge(i));
    return sign(excess) >= 0;
  }

  static COLLIDE_HD void times_square_of_radius(exact_products& sum) {
    sum.multiply_by(exact_slot::radius);
    sum.multiply_by(exact_slot::radius);
  }
};

/// True if the sphere touches the triangle until a time of at most 53 bits. Finite coordinates and a finite
/// radius, not below 0.
COLLIDE_HD_NOINLINE inline bool intersects_in_integers(triangle<double> const& t, moving_sphere<double> const& s,
                                                       dyadic time) {
  exact_sweep_slot::memory memory;
  return exact_sweep(exact_sweep_of(memory.table(), t, s, time)).intersects();
}

}  // namespace collide::detail
