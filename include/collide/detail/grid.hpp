/// \file
/// The uniform grids of the `bucket` broad phase.
///
/// Every triangle, dilated by the reach (the largest radius asked for) and a slack for rounding, is put into every cell
/// that its box touches; a sphere then looks into the one cell that holds its centre. No pair can appear twice, and the
/// spheres need no sorting.
///
/// What keeps the grid from collapsing:
///   - Levels. Triangles much larger than the rest go to a level of wider cells (each twice as wide as the one before),
///   so
///     that a triangle never touches more than a few cells; a sphere looks into one cell per level that is in use.
///   - Wrapping. A level has a fixed number of cells; where the scene has more, cell coordinates wrap around (modulo a
///   power
///     of two). Triangles from far away then share a cell: more candidates, no wrong answer.
///   - Several grids, where radii differ much: each serves the spheres of one range of radii.
///
/// The rounding: cell coordinates are floor((x - lower) * inverse_width), a monotone function, so rounding alone cannot
/// separate a centre from a box that contains it. The slack of 64 units in the last place of the largest coordinate
/// covers the rounding of the box itself and a compiler that reassociates. The reach is
/// dilated by 4 units of float too, the coarsest arithmetic of a narrow phase, so that none of its hits is lost here,
/// right or wrong. See docs/numerics.md.
#pragma once

#include <collide/detail/mesh_summary.hpp>

namespace collide::detail {

inline constexpr int max_levels = 16;
inline constexpr int max_grids = 8;

/// A range of cell coordinates per axis.
struct cell_range {
  std::uint32_t lower[3], upper[3];
};

/// Cells of one width.
template <class S>
struct grid_level {
  S inverse_width;
  S largest;               ///< the largest dilated extent of a triangle of this level
  std::uint32_t mask[3];   ///< number of cells - 1 per axis; cell coordinates wrap
  std::uint32_t shift[2];  ///< position of the bits of y and z in the cell number; those of x come first
  std::uint32_t first;     ///< number of the first cell

  /// Number of the first cell of a row along x.
  COLLIDE_HD_INLINE std::uint32_t row(std::uint32_t y, std::uint32_t z) const {
    return first + (((y & mask[1]) << shift[0]) | ((z & mask[2]) << shift[1]));
  }
};

/// The grid for spheres up to one radius.
template <class S>
struct grid {
  S reach;     ///< serves spheres of radius up to this
  S dilation;  ///< reach and slack: how far a triangle's box is dilated
  S width;     ///< of the cells of the finest level
  S lower[3];  ///< of the dilated mesh
  S upper[3];
  int levels;  ///< 0 if no triangle is in the grid
  grid_level<S> level[max_levels];

  /// Cell coordinate, before wrapping, of the coordinate `x` on an axis. Monotone in x; ends at 2^30.
  COLLIDE_HD_INLINE std::uint32_t coordinate(grid_level<S> const& l, S x, int axis) const {
    S const cells = mul(x - lower[axis], l.inverse_width);
    // without branches, and by way of a signed integer, for which all processors have an instruction
    S const limited = smaller(larger(S(0), cells), S(1 << 30));
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(limited));
  }

  /// The cell that holds a point inside the grid.
  COLLIDE_HD_INLINE std::uint32_t cell_of(grid_level<S> const& l, vec3<S> const& p) const {
    return l.row(coordinate(l, p.y(), 1), coordinate(l, p.z(), 2)) + (coordinate(l, p.x(), 0) & l.mask[0]);
  }

  /// The level that a triangle with this box belongs to.
  COLLIDE_HD_INLINE grid_level<S> const& level_of(box<S> const& b) const {
    if (levels == 1) return level[0];
    S const size = S(bin_end(size_bin(b.extent()))) + 2 * dilation;  // as plan_grid has it
    int l = 0;
    while (l + 1 < levels && !(size <= level[l].largest)) ++l;
    return level[l];
  }

  /// The cells that a triangle's dilated box touches.
  COLLIDE_HD_INLINE cell_range range_of(grid_level<S> const& l, box<S> const& b) const {
    cell_range r;
    for (int k = 0; k < 3; ++k) {
      r.lower[k] = coordinate(l, b.lower[k] - dilation, k);
      r.upper[k] = coordinate(l, b.upper[k] + dilation, k);
    }
    return r;
  }

  /// The cells that a triangle is put into: at most one whole turn of the level on each axis.
  COLLIDE_HD_INLINE cell_range cells_of(grid_level<S> const& l, box<S> const& b) const {
    cell_range r = range_of(l, b);
    for (int k = 0; k < 3; ++k) r.upper[k] = smaller(r.upper[k], r.lower[k] + l.mask[k]);
    return r;
  }

  /// Calls f(first, n) for runs of cells, first .. first + n, which are all that a triangle with this box is put into.
  template <class F>
  COLLIDE_HD_INLINE void each_row(box<S> const& b, F const& f) const {
    if (levels == 0 || b.is_empty()) return;
    grid_level<S> const& l = level_of(b);
    cell_range const r = cells_of(l, b);
    std::uint32_t const from = r.lower[0] & l.mask[0], n = r.upper[0] - r.lower[0] + 1;
    std::uint32_t const to_end = l.mask[0] + 1 - from;
    for (std::uint32_t z = r.lower[2]; z <= r.upper[2]; ++z) {
      for (std::uint32_t y = r.lower[1]; y <= r.upper[1]; ++y) {
        std::uint32_t const row = l.row(y, z);
        f(row + from, smaller(n, to_end));
        if (n > to_end) f(row, n - to_end);
      }
    }
  }
};

/// Kernel body of `for_each` over grids: chooses widths, levels and table sizes of each grid from the summary of the
/// mesh. A single thread's work of some microseconds, so that a build on the device need not wait for the host.
template <class S>
struct plan_grid {
  mesh_summary<S> const* summary;
  grid<S>* grids;
  S reaches[max_grids];
  S cell_width;              ///< asked for; 0 = choose
  int usual_span;            ///< how many cells wide most triangles are, if the width is not asked for
  float entry_limit;         ///< how many entries a grid may have, if the width is asked for
  std::uint32_t table_bits;  ///< log2 of the number of cells per grid

  COLLIDE_HD void operator()(std::size_t i) const {
    grid<S>& g = grids[i];
    g.reach = reaches[i];
    g.levels = 0;
    g.width = 0;
    size_histogram const& sizes = summary->extents;
    if (sizes.empty()) {  // no finite triangle: a box that contains nothing
      for (int k = 0; k < 3; ++k) {
        g.lower[k] = 1;
        g.upper[k] = -1;
      }
      return;
    }
    S far = g.reach;
    for (int k = 0; k < 3; ++k) far = larger(far, larger(abs_of(summary->lower_of(k)), abs_of(summary->upper_of(k))));
    g.dilation =
        g.reach * (1 + 4 * S(format<float>::unit)) + 64 * format<S>::unit * far + 64 * std::numeric_limits<S>::min();
    for (int k = 0; k < 3; ++k) {
      g.lower[k] = summary->lower_of(k) - g.dilation;
      g.upper[k] = summary->upper_of(k) + g.dilation;
    }

    S extent = 0;
    for (int k = 0; k < 3; ++k) extent = larger(extent, g.upper[k] - g.lower[k]);
    constexpr S end = std::numeric_limits<S>::max() / 16;
    int const top = sizes.last();
    S const tallest = margin * size(g, top);
    if (!(extent < end && far < end &&
          tallest < end)) {  // the range of S does not suffice: a grid that serves no sphere
      g.reach = -1;
      return;
    }
    // from this width on, cell coordinates are exact enough for `margin`
    S const narrowest = larger(96 * format<S>::unit * extent, 64 * std::numeric_limits<S>::min());
    S width = larger(narrowest,
                     cell_width > 0 ? cell_width : smaller(tallest, 2 * margin * size(g, median())) / S(usual_span));
    S const span = cell_width > 0 ? span_for(g, width) : S(usual_span);
    // half of the cells for the finest level, the rest for the others together; all if there are no others
    std::uint32_t next_cell = static_cast<std::uint32_t>(i) << table_bits;
    int bin = sizes.first();
    while (bin <= top) {
      if (g.levels + 1 == max_levels) width = larger(width, tallest / span);
      while (margin * size(g, bin) > width * span) width *= 2;
      int next = bin + 1;
      while (next <= top && (sizes.counts[next] == 0 || margin * size(g, next) <= width * span)) ++next;
      bool const last = next > top;
      grid_level<S>& l = g.level[g.levels++];
      if (g.levels == 1) g.width = width;
      l.inverse_width = div(S(1), width);
      l.largest = last ? std::numeric_limits<S>::infinity() : size(g, next - 1);
      l.first = next_cell;
      std::uint32_t bits = table_bits;
      if (g.levels > 1) {
        bits = table_bits - 5;
      } else if (!last) {
        bits = table_bits - 1;
      }
      next_cell += dimension(g, l, bits);
      width *= 2;
      bin = next;
    }
  }

 private:
  /// Cells are wider than the largest triangle of their level by this factor, so that rounding cannot make it touch
  /// more than `span` + 1 of them on an axis.
  static constexpr S margin = S(1.125);

  static COLLIDE_HD S abs_of(S x) { return x < 0 ? -x : x; }

  /// The largest dilated extent in a bin of the histogram.
  static COLLIDE_HD S size(grid<S> const& g, int bin) {
    return S(bin_end(static_cast<std::uint32_t>(bin))) + 2 * g.dilation;
  }

  /// The bin that half of the triangles do not exceed.
  COLLIDE_HD int median() const {
    size_histogram const& sizes = summary->extents;
    std::uint64_t total = 0;
    for (int b = sizes.first(); b <= sizes.last(); ++b) total += sizes.counts[b];
    int b = sizes.first();
    for (std::uint64_t below = sizes.counts[b]; 2 * below < total; below += sizes.counts[++b]) {
    }
    return b;
  }

  /// How many cells of the width asked for a triangle may span before it goes to a wider level: as many as the limit on
  /// entries allows, at most 64.
  COLLIDE_HD S span_for(grid<S> const& g, S width) const {
    size_histogram const& sizes = summary->extents;
    for (S span = 64; span > 1; span /= 2) {
      float entries = 0;
      for (int b = sizes.first(); b <= sizes.last(); ++b) {
        auto const cells = static_cast<float>(smaller(span, size(g, b) / width)) + 2;
        entries += static_cast<float>(sizes.counts[b]) * cells * cells * cells;
      }
      if (entries <= entry_limit) return span;
    }
    return 1;
  }

  /// Gives each axis of the level as many cells as the grid has, rounded up to a power of two, and halves the longest
  /// axes until 2^bits cells suffice. Returns their number.
  static COLLIDE_HD std::uint32_t dimension(grid<S> const& g, grid_level<S>& l, std::uint32_t bits) {
    std::uint32_t axis_bits[3], sum = 0;
    for (int k = 0; k < 3; ++k) {
      std::uint32_t const cells = g.coordinate(l, g.upper[k], k);
      axis_bits[k] = 0;
      while (axis_bits[k] < 30 && (1u << axis_bits[k]) <= cells) ++axis_bits[k];
      sum += axis_bits[k];
    }
    while (sum > bits) {
      int longest = 0;
      for (int k = 1; k < 3; ++k) longest = axis_bits[k] > axis_bits[longest] ? k : longest;
      --axis_bits[longest];
      --sum;
    }
    for (int k = 0; k < 3; ++k) l.mask[k] = (1u << axis_bits[k]) - 1;
    l.shift[0] = axis_bits[0];
    l.shift[1] = axis_bits[0] + axis_bits[1];
    return 1u << sum;
  }
};

/// Visits all cells of a triangle in all grids: the common part of counting and filling.
template <class S>
struct grid_insertion {
  mesh_view<S> mesh;
  grid<S> const* grids;
  int grid_count;

  template <class F>
  COLLIDE_HD_INLINE void each_cell(std::size_t i, F const& f) const {
    box<S> const b = box_of(mesh[i]);
    for (int n = 0; n < grid_count; ++n) {
      grids[n].each_row(b, [&](std::uint32_t first, std::uint32_t count) {
        for (std::uint32_t k = 0; k < count; ++k) f(first + k);
      });
    }
  }
};

/// Kernel body of `for_each` over triangles: counts the entries of each cell, and sets a bit for every cell that has
/// some.
template <class S>
struct count_entries {
  grid_insertion<S> insertion;
  std::uint32_t* counts;
  std::uint32_t* occupied;
  COLLIDE_HD void operator()(std::size_t i) const {
    insertion.each_cell(i, [&](std::uint32_t cell) {
      if (fetch_add(counts + cell, 1u) == 0) fetch_or(occupied + cell / 32, 1u << cell % 32);
    });
  }
};

/// Kernel body of `for_each` over triangles: writes the entries. `begins` holds where each cell's begin, and after all
/// triangles where they end.
template <class S>
struct fill_entries {
  grid_insertion<S> insertion;
  std::uint32_t* begins;
  id* entries;
  std::size_t capacity;
  COLLIDE_HD void operator()(std::size_t i) const {
    insertion.each_cell(i, [&](std::uint32_t cell) {
      std::uint32_t const slot = fetch_add(begins + cell, 1u);
      if (slot < capacity) entries[slot] = static_cast<id>(i);
    });
  }
};

}  // namespace collide::detail
