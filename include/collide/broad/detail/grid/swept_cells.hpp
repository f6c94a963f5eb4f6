/// \file
/// The path of a moving sphere's centre through a grid: docs/development/design.md, "Moving spheres", and R17 of
/// numerics.md.
///
/// Which piece of the path is the first to share a cell with a triangle is found without memory: the boxes of pieces
/// move in one direction on each axis, so the pieces whose cells a triangle shares follow each other.
#pragma once

#include <collide/broad/detail/grid/grid.hpp>

namespace collide::detail {

/// The cells of one level that a centre comes through, one after the other.
template <class S>
class swept_cells {
 public:
  swept_cells() = default;

  /// For a sphere that `is_traversable` in the grid, or whose path is short.
  COLLIDE_HD swept_cells(grid<S> const& g, grid_level<S> const& l, vec3<S> const& from, vec3<S> const& along)
      : grid_{&g}, level_{&l}, from_{from}, along_{along} {
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      S const to = from[k] + along[k], slack = rounding_slack(from[k], along[k]);
      box_.lower[k] = l.coordinate(offset(g, min(from[k], to) - slack, k), steps_.lower[k]);
      box_.upper[k] = l.coordinate(offset(g, max(from[k], to) + slack, k), steps_.upper[k]);
      segment_extent_[k] = box_.upper[k] - box_.lower[k] + 1;
    }
    if (!is_short(box_)) subdivide();
  }

  /// The cells of the box around all of the path.
  static COLLIDE_HD_INLINE cell_box cell_box_of_path(grid<S> const& g, grid_level<S> const& l, vec3<S> const& from,
                                                     vec3<S> const& along) {
    cell_box r;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      S const to = from[k] + along[k], slack = rounding_slack(from[k], along[k]);
      r.lower[k] = coordinate(g, l, min(from[k], to) - slack, k);
      r.upper[k] = coordinate(g, l, max(from[k], to) + slack, k);
    }
    return r;
  }

  /// True of a path in so few cells that it is one piece.
  static COLLIDE_HD_INLINE bool is_short(cell_box const& r) {
    return r.upper[0] - r.lower[0] <= 1 && r.upper[1] - r.lower[1] <= 1 && r.upper[2] - r.lower[2] <= 1;
  }

  /// True if the path comes through the grid's box, which a sphere must to touch a triangle.
  static COLLIDE_HD_INLINE bool overlaps_slab(S lower, S upper, S from, S along) {
    S const to = from + along, slack = rounding_slack(from, along);
    return min(from, to) - slack <= upper && max(from, to) + slack >= lower;
  }

  /// True if its cells can be counted.
  static COLLIDE_HD_INLINE bool is_traversable(S lower, S upper, S inverse_width, S from, S along) {
    constexpr S end = std::numeric_limits<S>::max() / 16;
    S const length = min(abs_of(along), upper - lower);
    return abs_of(from) < end && abs_of(along) < end && mul_rn(length, inverse_width) < S(1 << 20) &&
           mul_rn(rounding_slack(from, along), inverse_width) < 1;
  }

  /// Steps are numbered; in each there is one cell, or none. A cell of the piece before is not come to again.
  COLLIDE_HD_INLINE std::uint32_t steps() const { return segments_ * cells_per_segment(); }

  /// The cell of a step. Plain numbers: scratch memory is not constructed.
  struct cell_visit {
    std::uint32_t cell[3];
    std::uint32_t lower[3];  ///< where the piece that it belongs to begins
    cell_box before;         ///< the cells of the piece before; if there is none, none
    bool is_cell;
    bool is_single;          ///< there are no other cells on the path
    std::uint32_t coverage;  ///< of the cell: where in it the path is, or anywhere
    std::uint32_t later;  ///< axes on which there is a cell before: what begins in that has been come to; or `unknown`

    static constexpr std::uint32_t unknown = ~std::uint32_t{0};

    /// True if this is the first place on the path that shares a cell with a triangle in these cells.
    COLLIDE_HD_INLINE bool owns_pair(cell_box const& r) const {
      bool here = true, earlier = true;
      COLLIDE_UNROLL
      for (int k = 0; k < 3; ++k) {
        here = here && cell[k] == max(r.lower[k], lower[k]) && cell[k] <= r.upper[k];
        earlier = earlier && before.lower[k] <= r.upper[k] && r.lower[k] <= before.upper[k];
      }
      return here && !earlier;
    }
  };

  COLLIDE_HOT COLLIDE_HD cell_visit at(std::uint32_t step) const {
    std::uint32_t const number = step / cells_per_segment();
    std::uint32_t const rest = step % cells_per_segment();
    cell_box const piece = cells_of(number);
    cell_visit p;
    if (number != 0) {
      p.before = cells_of(number - 1);
    } else {
      COLLIDE_UNROLL
      for (int k = 0; k < 3; ++k) p.before.lower[k] = ~std::uint32_t{0}, p.before.upper[k] = 0;
    }
    std::uint32_t const offset[3] = {rest % segment_extent_[0], rest / segment_extent_[0] % segment_extent_[1],
                                     rest / (segment_extent_[0] * segment_extent_[1])};
    bool inside = true, again = true;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      p.lower[k] = piece.lower[k];
      p.cell[k] = piece.lower[k] + offset[k];
      inside = inside && p.cell[k] <= piece.upper[k];
      again = again && p.before.lower[k] <= p.cell[k] && p.cell[k] <= p.before.upper[k];
    }
    p.is_cell = inside && !again;
    p.is_single = steps() == 1;
    p.coverage = cell_coverage::full_query;
    p.later = cell_visit::unknown;
    if (is_subdivided_) return p;
    std::uint32_t coverage = 0, later = 0;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      bool const is_first = p.cell[k] == box_.lower[k], is_last = p.cell[k] == box_.upper[k];
      coverage |= cell_coverage::encode_query(is_first ? steps_.lower[k] : cell_coverage::first,
                                              is_last ? steps_.upper[k] : cell_coverage::last, k);
      later |= is_first ? 0 : cell_coverage::axis(k);
    }
    p.coverage = coverage;
    if (level_->is_spread()) p.later = later;  // else what begins in another cell of this number seems to begin here
    return p;
  }

  /// How far a coordinate on the path may be off by rounding.
  static COLLIDE_HD_INLINE S rounding_slack(S from, S along) {
    return 8 * ieee_traits<S>::unit_roundoff * (abs_of(from) + abs_of(along)) + 8 * std::numeric_limits<S>::min();
  }

 private:
  static COLLIDE_HD_INLINE S abs_of(S x) { return x < 0 ? -x : x; }

  /// A bit farther in a direction than `t`, which may be inaccurate.
  static COLLIDE_HD S widened(S t, S direction) {
    return t + mul_rn(direction * 8 * ieee_traits<S>::unit_roundoff, abs_of(t));
  }

  /// The coordinate of a cell. A point beyond the grid, where there are no cells, counts as its first or last cell.
  static COLLIDE_HD_INLINE std::uint32_t coordinate(grid<S> const& g, grid_level<S> const& l, S x, int k) {
    return l.coordinate(offset(g, x, k));
  }
  static COLLIDE_HD_INLINE S offset(grid<S> const& g, S x, int k) { return min(x, g.upper[k]) - g.lower[k]; }

  COLLIDE_HD std::uint32_t cells_per_segment() const {
    return segment_extent_[0] * segment_extent_[1] * segment_extent_[2];
  }

  COLLIDE_HD S position(std::uint32_t segment, int k) const {
    return from_[k] + mul_rn(begin_ + mul_rn(static_cast<S>(segment), segment_dt_), along_[k]);
  }

  /// Cuts a path through many cells into pieces.
  COLLIDE_HD void subdivide() {
    S end = 1, longest = 0;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      if (along_[k] == 0) continue;
      S const slack = rounding_slack(from_[k], along_[k]);
      S const to_lower = div_rn(grid_->lower[k] - slack - from_[k], along_[k]),
              to_upper = div_rn(grid_->upper[k] + slack - from_[k], along_[k]);
      begin_ = max(begin_, widened(min(to_lower, to_upper), -1));
      end = min(end, widened(max(to_lower, to_upper), 1));
    }
    is_subdivided_ = true;
    segments_ = 0;
    if (!(begin_ <= end)) return;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) longest = max(longest, mul_rn(abs_of(along_[k]), end - begin_));
    segments_ = static_cast<std::uint32_t>(mul_rn(longest, 2 * level_->inverse_width)) + 1;
    segment_dt_ = div_rn(end - begin_, static_cast<S>(segments_));
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      S const extent = mul_rn(abs_of(along_[k]), segment_dt_) + 2 * rounding_slack(from_[k], along_[k]);
      segment_extent_[k] = static_cast<std::uint32_t>(mul_rn(extent, level_->inverse_width) + S(0.125)) + 2;
    }
  }

  COLLIDE_HOT COLLIDE_HD cell_box cells_of(std::uint32_t piece) const {
    if (!is_subdivided_) return box_;
    cell_box r;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      S const a = position(piece, k), b = position(piece + 1, k), slack = rounding_slack(from_[k], along_[k]);
      r.lower[k] = coordinate(*grid_, *level_, min(a, b) - slack, k);
      r.upper[k] = coordinate(*grid_, *level_, max(a, b) + slack, k);
    }
    return r;
  }

  grid<S> const* grid_ = nullptr;
  grid_level<S> const* level_ = nullptr;
  vec3<S> from_ = vec3<S>::Zero(), along_ = vec3<S>::Zero();
  cell_box box_;                     ///< the cells of the box around the path
  cell_box steps_;                   ///< where in the first and the last cell on each axis the path begins and ends
  std::uint32_t segment_extent_[3];  ///< how many cells a piece has on an axis, at most
  std::uint32_t segments_ = 1;
  bool is_subdivided_ = false;    ///< else the only piece is the whole path
  S begin_ = 0, segment_dt_ = 0;  ///< times
};

}  // namespace collide::detail
