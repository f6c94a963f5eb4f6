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

#include <collide/broad/detail/grid/cell_coverage.hpp>
#include <collide/broad/detail/grid/size_histogram.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>

namespace collide::detail {

inline constexpr int max_levels = 2;
inline constexpr int max_grids = 8;

/// A range of cell coordinates per axis.
struct cell_box {
  std::uint32_t lower[3], upper[3];
};

/// Cells of one width.
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

  /// True if it serves spheres of this radius.
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
