/// \file
/// The cells that a dilated triangle itself meets, not only its box: it is cut into slabs of cells, what is in a slab
/// into rows along x, and what is in a row spans a run of cells.
///
/// A slab that is beyond the triangle meets only what is within the rest of the reach there, as Pythagoras has it. So
/// the corners of the dilated box are left out, too, where cells are small against the reach. The rounding:
/// docs/development/numerics.md, R11.
#pragma once

#include <cstdint>
#include <limits>

#include <collide/broad/detail/grid/grid.hpp>

namespace collide::detail {

/// The part of a triangle in a slab, seen along the slab's axis: the parts of its edges, and the lines along which
/// the slab cuts it. Its coordinates are x, and v on the axis of the rows.
template <class S>
class triangle_slab {
 public:
  /// The part of a triangle with lower <= u <= upper, where u is its coordinate on the slab's axis.
  COLLIDE_HD triangle_slab(S const (&u)[3], S const (&v)[3], S const (&x)[3], S lower, S upper) {
    COLLIDE_UNROLL
    for (int i = 0; i < 3; ++i) {
      int const j = i == 2 ? 0 : i + 1;
      S const to_lower[2] = {u[i] - lower, u[j] - lower}, to_upper[2] = {u[i] - upper, u[j] - upper};
      bool const below[2] = {to_lower[0] < 0, to_lower[1] < 0}, above[2] = {to_upper[0] > 0, to_upper[1] > 0};
      there_[i] = !(below[0] && below[1]) && !(above[0] && above[1]);
      S ends[2][2] = {{v[i], x[i]}, {v[j], x[j]}};
      auto const cut = [&](S const(&distance)[2], int line, bool& begun, int outside) {
        S const t = fraction(distance[0], distance[1]),
                at[2] = {v[i] + mul_rn(t, v[j] - v[i]), x[i] + mul_rn(t, x[j] - x[i])};
        for (int k = 0; k < 2; ++k) {
          if (outside == 0) ends[0][k] = at[k];
          if (outside == 1) ends[1][k] = at[k];
          if (!begun) segments_[line][0][k] = at[k];
          segments_[line][1][k] = at[k];
        }
        begun = true;
      };
      if (below[0] != below[1]) cut(to_lower, 3, there_[3], below[0] ? 0 : 1);
      if (above[0] != above[1]) cut(to_upper, 4, there_[4], above[0] ? 0 : 1);
      for (int e = 0; e < 2; ++e) {
        for (int k = 0; k < 2; ++k) segments_[i][e][k] = ends[e][k];
      }
    }
  }

  /// Over what range of v it is: an empty one, with lower > upper, if nothing is left.
  COLLIDE_HD void extent_on_v(S& lower, S& upper) const {
    lower = std::numeric_limits<S>::max(), upper = -lower;
    for (int i = 0; i < segment_count; ++i) {
      if (!there_[i]) continue;
      lower = min(lower, min(segments_[i][0][0], segments_[i][1][0]));
      upper = max(upper, max(segments_[i][0][0], segments_[i][1][0]));
    }
  }

  /// Over what range of x it is in the row from `begin` to `end` on v.
  COLLIDE_HD void extent_on_x(S begin, S end, S& lower, S& upper) const {
    lower = std::numeric_limits<S>::max(), upper = -lower;
    for (int i = 0; i < segment_count; ++i) {
      S const(&p)[2] = segments_[i][0], (&q)[2] = segments_[i][1];
      if (!there_[i] || (p[0] < begin && q[0] < begin) || (p[0] > end && q[0] > end)) continue;
      S from = p[1], to = q[1];
      if ((p[0] < begin) != (q[0] < begin)) (p[0] < begin ? from : to) = x_at(p, q, begin);
      if ((p[0] > end) != (q[0] > end)) (p[0] > end ? from : to) = x_at(p, q, end);
      lower = min(lower, min(from, to));
      upper = max(upper, max(from, to));
    }
  }

 private:
  static constexpr int segment_count = 5;

  static COLLIDE_HD_INLINE S x_at(S const (&p)[2], S const (&q)[2], S v) {
    return p[1] + mul_rn(fraction(p[0] - v, q[0] - v), q[1] - p[1]);
  }

  /// How far along the line between two points a plane lies that they are so far from, on different sides.
  static COLLIDE_HD_INLINE S fraction(S here, S there) {
    S const apart = here - there;
    return apart != 0 ? div_approximately(here, apart) : S(0);
  }

  S segments_[segment_count][2][2];  ///< (v, x) of both ends: three edges, the cut at the slab's begin, that at its end
  bool there_[segment_count] = {};
};

/// Calls f(number, n) for the one or two runs of cells, number .. number + n, of a row from `first` to `last`.
template <class S, class F>
void each_range_of_row(grid_level<S> const& l, std::uint32_t y, std::uint32_t z, std::uint32_t first,
                       std::uint32_t last, F const& f) {
  std::uint32_t const row = l.row(y, z), begin = first & l.mask[0], n = last - first + 1;
  std::uint32_t const to_end = l.mask[0] + 1 - begin;
  f(row + begin, min(n, to_end));
  if (n > to_end) f(row, n - to_end);
}

/// Calls f(number, n) for the runs of cells of all rows of a box of cells.
template <class S, class F>
void each_range_of_box(grid_level<S> const& l, cell_box const& r, F const& f) {
  for (std::uint32_t z = r.lower[2]; z <= r.upper[2]; ++z) {
    for (std::uint32_t y = r.lower[1]; y <= r.upper[1]; ++y) each_range_of_row(l, y, z, r.lower[0], r.upper[0], f);
  }
}

/// The cells of a level into which a triangle is entered.
template <class S>
class triangle_cells {
 public:
  /// The cells of the triangle with this box. It is not cut, but entered into all cells that its dilated box meets, if
  /// the grid wants that, or if there are few.
  COLLIDE_HD triangle_cells(grid<S> const& g, grid_level<S> const& l, aabb<S> const& b)
      : grid_{g}, level_{l}, box_{b}, range_{g.cells_of(l, b, first_step_, last_step_)} {
    bool turns = false;
    std::uint32_t n[3];
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      turns = turns || first_step_[k] == cell_coverage::before;
      n[k] = range_.upper[k] - range_.lower[k] + 1;
    }
    // after a turn a row would be come to again
    is_cut_ = !g.whole_boxes && !turns && (n[0] > 2 || n[1] > 2 || n[2] > 2);
    slabs_on_z_ = n[2] >= n[1];
  }

  /// True if its box meets so few cells that it is entered into all of them: to cut it would cost more.
  COLLIDE_HD_INLINE bool is_small() const {
    std::uint32_t const x = range_.upper[0] - range_.lower[0] + 1, y = range_.upper[1] - range_.lower[1] + 1,
                        z = range_.upper[2] - range_.lower[2] + 1;
    return x <= 3 && y <= 3 && z <= 3 && x * y * z <= 18;
  }

  COLLIDE_HD_INLINE std::uint32_t slabs() const {
    int const u = slab_axis();
    return range_.upper[u] - range_.lower[u] + 1;
  }

  /// Calls f(y, z, first, last) for the runs of cells of slab `k`, from (first, y, z) to (last, y, z): no cell twice.
  template <class F>
  COLLIDE_HD void each_run(std::uint32_t k, triangle<S> const& t, F const& f) const {
    std::uint32_t const slab = (slabs_on_z_ ? range_.lower[2] : range_.lower[1]) + k;
    std::uint32_t first_row = slabs_on_z_ ? range_.lower[1] : range_.lower[2],
                  last_row = slabs_on_z_ ? range_.upper[1] : range_.upper[2];
    auto const call = [&](std::uint32_t row, std::uint32_t first, std::uint32_t last) {
      f(slabs_on_z_ ? row : slab, slabs_on_z_ ? slab : row, first, last);
    };
    if (!is_cut_) {
      for (std::uint32_t row = first_row; row <= last_row; ++row) call(row, range_.lower[0], range_.upper[0]);
      return;
    }
    int const u_axis = slab_axis(), v_axis = 3 - u_axis;
    S const reach = grid_.padded_reach, begin = cell_begin(slab, u_axis), end = begin + level_.width;
    S const reach_squared = mul_rn(reach, reach),
            left = squared_rest(reach_squared, begin, end, on(box_.lower, u_axis), on(box_.upper, u_axis));
    if (left < 0) return;
    S const u[3] = {on(t.a, u_axis), on(t.b, u_axis), on(t.c, u_axis)},
            v[3] = {on(t.a, v_axis), on(t.b, v_axis), on(t.c, v_axis)}, x[3] = {t.a[0], t.b[0], t.c[0]};
    triangle_slab<S> const part(u, v, x, begin - reach, end + reach);
    S lower, upper;
    part.extent_on_v(lower, upper);
    if (!(lower <= upper)) return;
    S const reach_on_v = sqrt_rn(left);
    first_row = max(first_row, coordinate(lower - reach_on_v, v_axis));
    last_row = min(last_row, coordinate(upper + reach_on_v, v_axis));
    for (std::uint32_t row = first_row; row <= last_row; ++row) {
      S const row_begin = cell_begin(row, v_axis), row_end = row_begin + level_.width;
      S const rest = squared_rest(left, row_begin, row_end, lower, upper);
      if (rest < 0) continue;
      S from, to;
      part.extent_on_x(row_begin - reach_on_v, row_end + reach_on_v, from, to);
      if (!(from <= to)) continue;
      S const reach_on_x = sqrt_rn(rest);
      std::uint32_t const first = max(range_.lower[0], coordinate(from - reach_on_x, 0)),
                          last = min(range_.upper[0], coordinate(to + reach_on_x, 0));
      if (first <= last) call(row, first, last);
    }
  }

  /// Calls f(number, n) for runs of cells, number .. number + n: no cell twice. `get_triangle()` is the triangle.
  template <class GetTriangle, class F>
  void each_range(GetTriangle const& get_triangle, F const& f) const {
    if (is_cut_) {
      triangle<S> const t = get_triangle();
      for (std::uint32_t k = 0; k < slabs(); ++k) {
        each_run(k, t, [&](std::uint32_t y, std::uint32_t z, std::uint32_t first, std::uint32_t last) {
          each_range_of_row(level_, y, z, first, last, f);
        });
      }
    } else {
      each_range_of_box(level_, range_, f);
    }
  }

  /// A cell, and which part of it the dilated box covers.
  COLLIDE_HD_INLINE cell_ref at(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return {level_.row(y, z) + (x & level_.mask[0]), covered(x, 0) | covered(y, 1) | covered(z, 2)};
  }

  /// The cells that the dilated box meets, at most one whole turn of the level on each axis.
  COLLIDE_HD_INLINE cell_box const& range() const { return range_; }

 private:
  COLLIDE_HD_INLINE int slab_axis() const { return slabs_on_z_ ? 2 : 1; }

  /// Component 1 or 2 of a vector, without making an array of it.
  template <class V>
  static COLLIDE_HD_INLINE S on(V const& p, int axis) {
    return axis == 2 ? p[2] : p[1];
  }

  COLLIDE_HD_INLINE S cell_begin(std::uint32_t cell, int axis) const {
    return (axis == 2 ? grid_.lower[2] : grid_.lower[1]) + mul_rn(static_cast<S>(cell), level_.width);
  }
  COLLIDE_HD_INLINE std::uint32_t coordinate(S x, int axis) const {
    return level_.coordinate(x - (axis == 0 ? grid_.lower[0] : (axis == 1 ? grid_.lower[1] : grid_.lower[2])));
  }

  /// A squared length, less the squared distance of two ranges.
  static COLLIDE_HD_INLINE S squared_rest(S squared, S begin, S end, S lower, S upper) {
    S const apart = max(S(0), max(begin - upper, lower - end));
    return squared - mul_rn(apart, apart);
  }

  COLLIDE_HD_INLINE std::uint32_t covered(std::uint32_t cell, int axis) const {
    return cell_coverage::encode_box(cell == range_.lower[axis] ? first_step_[axis] : cell_coverage::before,
                                     cell == range_.upper[axis] ? last_step_[axis] : cell_coverage::last, axis);
  }

  grid<S> const& grid_;
  grid_level<S> const& level_;
  aabb<S> box_;
  std::uint32_t first_step_[3], last_step_[3];
  cell_box range_;
  bool is_cut_, slabs_on_z_;
};

/// Calls f(number, n) for runs of cells, number .. number + n, that a triangle with this box is entered into: no cell
/// twice. `get_triangle()` is the triangle.
template <class S, class GetTriangle, class F>
void each_range(grid<S> const& g, aabb<S> const& b, GetTriangle const& get_triangle, F const& f) {
  if (g.levels == 0 || b.is_empty()) return;
  grid_level<S> const& l = g.level_of(b);
  cell_box const r = g.range_of(l, b);
  bool few = true;  // nearly always: then nothing else has to be known
  COLLIDE_UNROLL
  for (int k = 0; k < 3; ++k) few = few && r.upper[k] - r.lower[k] <= min(1u, l.mask[k]);
  if (few) return each_range_of_box(l, r, f);
  triangle_cells<S>(g, l, b).each_range(get_triangle, f);
}

}  // namespace collide::detail
