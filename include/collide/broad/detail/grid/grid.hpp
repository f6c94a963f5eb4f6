/// \file
/// The uniform grids of the `bucket` broad phase; docs/development/design.md says what keeps them from collapsing.
///
/// Every triangle, dilated by the reach (the largest radius asked for) and a slack for rounding, is put into the cells
/// that it meets; a sphere then looks into the one cell that holds its centre. That no pair is lost, and none appears
/// twice: docs/development/numerics.md, "The grid".
///
/// An entry is the number of a triangle. Beside it is which part of the cell the triangle's box covers, to a fifteenth
/// of the cell's width, so that most triangles of a cell that are not near a sphere in it are left out before anything
/// else of them is read.
#pragma once

#include <cstdint>

#include <collide/broad/detail/grid/size_histogram.hpp>
#include <collide/core/geometry.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// The part of a cell that a box covers, and what may be in it. A cell is 15 steps wide on each axis: 14 sixteenths of
/// its width, and the rest. Both are six numbers of 5 bits, two for each axis, such that a sum tells whether they meet:
/// those of a side of the box, at most 17 and 14, add up to 16 or more unless all that may be there is beyond it.
struct cell_coverage {
  static constexpr std::uint32_t first = 1, last = 15;     ///< steps
  static constexpr std::uint32_t before = 0;               ///< in place of a first step: begins in a cell before
  static constexpr std::uint32_t carry_mask = 0x21084210;  ///< 16 in all numbers
  static constexpr std::uint32_t full_box = 0x1ef7c631;    ///< a box that covers the cell, and begins before it
  static constexpr std::uint32_t full_query = 0x1ef7b9ce;  ///< what is everywhere in the cell

  /// The step at a fraction of a cell.
  template <class S>
  static COLLIDE_HD_INLINE std::uint32_t subcell_of(S fraction) {
    auto const sixteenths = static_cast<std::uint32_t>(static_cast<std::int32_t>(fraction * S(16)));
    return min(sixteenths, last - first) + first;
  }

  /// A box from the step `from` to the step `to` of an axis; to be united by `|` with the other axes.
  static COLLIDE_HD_INLINE std::uint32_t encode_box(std::uint32_t from, std::uint32_t to, int axis) {
    return (17 - from) << 5 * axis | to << (5 * axis + 15);
  }

  /// The bits from the step `from` to the step `to` of an axis; to be united with the other axes.
  static COLLIDE_HD_INLINE std::uint32_t encode_query(std::uint32_t from, std::uint32_t to, int axis) {
    return (to - 1) << 5 * axis | (16 - from) << (5 * axis + 15);
  }

  static COLLIDE_HD_INLINE bool overlaps(std::uint32_t coverage, std::uint32_t query) {
    return ((coverage + query) & carry_mask) == carry_mask;
  }

  /// An axis, to be united with others.
  static COLLIDE_HD_INLINE std::uint32_t axis(int k) { return 1u << 5 * k; }

  /// True if the box begins in a cell before on one of these axes.
  static COLLIDE_HD_INLINE bool starts_in_earlier_cell(std::uint32_t coverage, std::uint32_t axes) {
    return (coverage >> 4 & coverage & axes) != 0;  // 17, the only odd number from 16 on
  }
};

/// A cell, and a part of it or a place in it.
struct cell_ref {
  std::uint32_t number, coverage;
};

/// An entry of a cell: a triangle, and the part of the cell that its dilated box covers.
struct alignas(8) cell_item {
  id triangle;
  std::uint32_t coverage;
};

inline constexpr int max_levels = 2;
inline constexpr int max_grids = 8;

/// A range of cell coordinates per axis.
struct cell_box {
  std::uint32_t lower[3], upper[3];
};

template <class S>
struct grid_level {
  S width, inverse_width;
  S largest;                ///< the largest extent of a triangle of this level
  std::uint32_t mask[3];    ///< where cell coordinates wrap: a power of two - 1
  std::uint32_t stride[2];  ///< how far the cells of neighbours in y and in z are apart
  std::uint32_t first;      ///< number of the first cell

  /// How many cells fit below an offset from the grid's lower end; from 0 to 2^30.
  COLLIDE_HD_INLINE std::uint32_t coordinate(S offset) const { return whole(cells_below(offset)); }

  /// How many cells fit below an offset, and in which of the 15 slabs of the next cell it ends (`step`).
  COLLIDE_HD_INLINE std::uint32_t coordinate(S offset, std::uint32_t& step) const {
    S const cells = cells_below(offset);
    std::uint32_t const full = whole(cells);
    step = cell_coverage::subcell_of(cells - static_cast<S>(full));
    return full;
  }

  /// How many cells fit below an offset that is not above the grid's upper end; any number for other offsets.
  COLLIDE_HD_INLINE std::uint32_t coordinate_inside(S offset) const {
#if defined(__CUDA_ARCH__)
    if constexpr (sizeof(S) == 4) return __float2uint_rz(mul_rn(offset, inverse_width));  // 0 of what is less
#endif
    return coordinate(offset);
  }

  /// The cell that holds a point inside the grid, whose lower end this is, and the place of the point in it.
  COLLIDE_HD_INLINE cell_ref cell_at(vec3<S> const& p, S const (&lower)[3]) const {
    std::uint32_t cell[3], place = 0;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      std::uint32_t step;
      cell[k] = coordinate(p[k] - lower[k], step);
      place |= cell_coverage::encode_query(step, step, k);
    }
    return {row(cell[1], cell[2]) + (cell[0] & mask[0]), place};
  }

  /// True if no cell has the number of another.
  COLLIDE_HD_INLINE bool is_spread() const { return (mask[0] & mask[1] & mask[2]) == (1u << 31) - 1; }

  /// Number of the first cell of a row along x.
  COLLIDE_HD_INLINE std::uint32_t row(std::uint32_t y, std::uint32_t z) const {
    return first + (y & mask[1]) * stride[0] + (z & mask[2]) * stride[1];
  }

 private:
  /// Without branches.
  COLLIDE_HD_INLINE S cells_below(S offset) const { return min(max(S(0), mul_rn(offset, inverse_width)), S(1 << 30)); }

  /// Through a signed integer, for which all processors have an instruction.
  static COLLIDE_HD_INLINE std::uint32_t whole(S x) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(x)); }
};

/// A grid without its levels.
template <class S>
struct grid_header {
  S reach;           ///< serves spheres of radius up to this
  S dilation;        ///< reach and slack: how far a triangle's box is dilated
  S width;           ///< of the cells of the finest level
  S padded_reach;    ///< what is within this of a triangle is in its cells: dilation, and slack for cutting it
  bool whole_boxes;  ///< triangles are in all cells that their dilated boxes meet, as swept queries need it
  S lower[3];        ///< of the dilated mesh
  S upper[3];
  int levels;           ///< 0 if no triangle is in the grid
  std::uint32_t cells;  ///< how many there are, of all levels

  /// Cell coordinate, before wrapping, of the coordinate `x` on an axis. Monotone in x; ends at 2^30.
  COLLIDE_HD_INLINE std::uint32_t coordinate(grid_level<S> const& l, S x, int axis) const {
    return l.coordinate(x - lower[axis]);
  }

  COLLIDE_HD_INLINE bool serves(S radius) const { return radius <= reach; }

  /// True if a point is inside its box. Without branches, for the CPU's vector unit.
  COLLIDE_HD_INLINE bool contains(S x, S y, S z) const {
    return (x >= lower[0]) & (x <= upper[0]) & (y >= lower[1]) & (y <= upper[1]) & (z >= lower[2]) & (z <= upper[2]);
  }

  /// The cells that a triangle with this box is put into, at most one whole turn of the level on each axis, and the
  /// steps in the first and the last of them from and up to which the dilated box reaches.
  COLLIDE_HD_INLINE cell_box cells_of(grid_level<S> const& l, aabb<S> const& b, std::uint32_t (&from)[3],
                                      std::uint32_t (&to)[3]) const {
    cell_box r;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      r.lower[k] = l.coordinate(b.lower[k] - dilation - lower[k], from[k]);
      r.upper[k] = l.coordinate(b.upper[k] + dilation - lower[k], to[k]);
      bool const turns = r.upper[k] - r.lower[k] > l.mask[k];  // then a cell may be the first and a later one, too
      from[k] = turns ? cell_coverage::before : from[k];
      to[k] = turns ? cell_coverage::last : to[k];
      r.upper[k] = turns ? r.lower[k] + l.mask[k] : r.upper[k];
    }
    return r;
  }
};

/// The grid for spheres up to one radius.
template <class S>
struct grid : grid_header<S> {
  using grid_header<S>::levels, grid_header<S>::dilation, grid_header<S>::coordinate;

  grid_level<S> level[max_levels];

  /// The level that a triangle with this box belongs to.
  COLLIDE_HD_INLINE grid_level<S> const& level_of(aabb<S> const& b) const {
    if (levels <= 1) return level[0];
    return S(bin_end(size_bin(b.max_extent()))) <= level[0].largest ? level[0] : level[1];
  }

  /// The cells that a triangle's dilated box touches.
  COLLIDE_HD_INLINE cell_box range_of(grid_level<S> const& l, aabb<S> const& b) const {
    cell_box r;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      r.lower[k] = coordinate(l, b.lower[k] - dilation, k);
      r.upper[k] = coordinate(l, b.upper[k] + dilation, k);
    }
    return r;
  }

  /// The cell that holds a point inside the grid, and the place of the point in it.
  COLLIDE_HD_INLINE cell_ref cell_at(grid_level<S> const& l, vec3<S> const& p) const {
    return l.cell_at(p, this->lower);
  }
};

/// The triangles of a cell.
struct alignas(8) item_range {
  std::uint32_t count;
  std::uint32_t end;  ///< of its entries; while they are written, of those that are
};

}  // namespace collide::detail
