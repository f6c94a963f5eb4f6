/// \file
/// How wide the cells of a grid are, how many levels it has and how large its table is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/detail/grid/grid.hpp>
#include <collide/detail/grid/mesh_statistics.hpp>

namespace collide::detail {

/// Kernel body of a block per grid: chooses widths, levels and table sizes from the summary of the mesh. A single
/// lane's work of some microseconds, so that a build on the device need not wait for the host; much of that is fetching
/// instructions, so the fewer the better.
template <class S>
struct plan_grid {
  static constexpr int items = 1;

  mesh_statistics<S> const* summary;
  grid<S>* grids;
  S reaches[max_grids];
  S cell_width;              ///< asked for; 0 = choose
  S target_span;             ///< how many cells wide most triangles are at most, if the width is not asked for
  float entry_limit;         ///< how many entries a grid may have, if the width is asked for
  std::uint32_t table_bits;  ///< log2 of the number of cells per grid

  template <class Block>
  struct scratch {
    typename Block::template staging<std::uint32_t, size_bins> counts;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    std::uint32_t const* const counts = block.stage(s.counts, summary->extents.counts, size_bins);
    block.for_each_thread([&](int thread_rank) {
      if (thread_rank != 0) return;
      auto& g = grids[block.index()];
      sizes const seen{counts, summary->extents.first(), summary->extents.last()};
      static_cast<grid_header<S>&>(g) = plan(block.index(), seen, g.level);
    });
  }

 private:
  /// The histogram of the triangles' extents; the bins in use are first .. last.
  struct sizes {
    std::uint32_t const* counts;
    int first, last;
  };

  /// Sets the levels and returns the rest.
  COLLIDE_HD grid_header<S> plan(std::size_t i, sizes const& seen, grid_level<S>* levels) const {
    grid_header<S> g{};
    g.reach = reaches[i];
    levels[0] = {};       // is read before it is known whether there is one
    if (seen.last < 0) {  // no finite triangle: a box that contains nothing
      for (int k = 0; k < 3; ++k) {
        g.lower[k] = 1;
        g.upper[k] = -1;
      }
      return g;
    }
    S extent = 0;
    S const far = set_box(g, extent), tallest = margin * size(g, seen.last);
    constexpr S end = std::numeric_limits<S>::max() / 16;
    if (!(extent < end && far < end && tallest < end)) {  // the range of S does not suffice: it serves no sphere
      g.reach = -1;
      return g;
    }
    // from this width on, cell coordinates are exact enough for `margin`
    S const narrowest = larger(96 * ieee_traits<S>::unit_roundoff * extent, 64 * std::numeric_limits<S>::min());
    // the largest must fit also when the quotient is rounded down
    S const usual = div(smaller(tallest, 2 * margin * size(g, median(seen))), target_span) *
                    (1 + 4 * ieee_traits<S>::unit_roundoff);
    S const width = larger(narrowest, cell_width > 0 ? cell_width : usual);
    S const span = cell_width > 0 ? span_for(g, width, seen) : target_span;
    set_levels(g, width, span, seen, static_cast<std::uint32_t>(i) << table_bits, levels);
    return g;
  }

  /// Sets the dilation and the box of the dilated mesh, and `extent` to the longest edge of that. Returns the largest
  /// coordinate of the mesh, or the reach if that is larger.
  COLLIDE_HD S set_box(grid_header<S>& g, S& extent) const {
    S far = g.reach;
    for (int k = 0; k < 3; ++k) {
      g.lower[k] = summary->lower_of(k);
      g.upper[k] = summary->upper_of(k);
      far = larger(far, larger(abs_of(g.lower[k]), abs_of(g.upper[k])));
    }
    g.dilation = g.reach * (1 + 4 * S(ieee_traits<float>::unit_roundoff)) + 64 * ieee_traits<S>::unit_roundoff * far +
                 64 * std::numeric_limits<S>::min();
    for (int k = 0; k < 3; ++k) {
      g.lower[k] -= g.dilation;
      g.upper[k] += g.dilation;
      extent = larger(extent, g.upper[k] - g.lower[k]);
    }
    return far;
  }

  /// Makes levels, the finest with cells of this width, in which a triangle spans `span` cells at most. Half of the
  /// cells are for the finest level, the rest for the others together; all if there are no others.
  COLLIDE_HD void set_levels(grid_header<S>& g, S width, S span, sizes const& seen, std::uint32_t first_cell,
                             grid_level<S>* levels) const {
    S const tallest = margin * size(g, seen.last);
    int bin = seen.first;
    while (bin <= seen.last) {
      if (g.levels + 1 == max_levels) width = larger(width, tallest / span);
      while (margin * size(g, bin) > width * span) width *= 2;
      int next = bin + 1;
      while (next <= seen.last && (seen.counts[next] == 0 || margin * size(g, next) <= width * span)) ++next;
      bool const last = next > seen.last;
      grid_level<S>& l = levels[g.levels++];
      if (g.levels == 1) g.width = width;
      l.inverse_width = div(S(1), width);
      l.largest = last ? std::numeric_limits<S>::infinity() : size(g, next - 1);
      l.first = first_cell + g.cells;
      std::uint32_t bits = table_bits;
      if (g.levels > 1) {
        bits = table_bits - 5;
      } else if (!last) {
        bits = table_bits - 1;
      }
      g.cells += dimension(g, l, std::uint32_t{1} << bits);
      width *= 2;
      bin = next;
    }
  }

  /// Cells are wider than the largest triangle of their level by this factor, so that rounding cannot make it touch
  /// more than `span` + 1 of them on an axis.
  static constexpr S margin = S(1.125);

  static COLLIDE_HD S abs_of(S x) { return x < 0 ? -x : x; }

  /// The largest extent in a bin of the histogram, and the largest dilated one.
  static COLLIDE_HD S size(int bin) { return S(bin_end(static_cast<std::uint32_t>(bin))); }
  static COLLIDE_HD S size(grid_header<S> const& g, int bin) { return size(bin) + 2 * g.dilation; }

  /// The bin that half of the sizes do not exceed.
  static COLLIDE_HD int median(sizes const& seen) {
    std::uint64_t total = 0;
    COLLIDE_NO_UNROLL
    for (int b = seen.first; b <= seen.last; ++b) total += seen.counts[b];
    int b = seen.first;
    COLLIDE_NO_UNROLL
    for (std::uint64_t below = seen.counts[b]; 2 * below < total; below += seen.counts[++b]) {
    }
    return b;
  }

  /// How many cells of the width asked for a triangle may span before it goes to a wider level: as many as the limit on
  /// entries allows, at most 64.
  COLLIDE_HD S span_for(grid_header<S> const& g, S width, sizes const& seen) const {
    for (S span = 64; span > 1; span /= 2) {
      float entries = 0;
      for (int b = seen.first; b <= seen.last; ++b) {
        auto const cells = static_cast<float>(smaller(span, size(g, b) / width)) + 2;
        entries += static_cast<float>(seen.counts[b]) * cells * cells * cells;
      }
      if (entries <= entry_limit) return span;
    }
    return 1;
  }

  /// Gives each axis of the level as many cells as the grid has, and if that is more than `most` in all, cuts the
  /// longest axes down to powers of two, where coordinates wrap. Returns the number of cells.
  static COLLIDE_HD std::uint32_t dimension(grid_header<S> const& g, grid_level<S>& l, std::uint64_t most) {
    std::uint64_t cells[3];
    for (int k = 0; k < 3; ++k) {
      cells[k] = std::uint64_t{g.coordinate(l, g.upper[k], k)} + 1;
      l.mask[k] = (1u << 31) - 1;
    }
    // no product overflows: there are at most 2^30 + 1 cells on an axis
    while (cells[0] * cells[1] > most || cells[0] * cells[1] * cells[2] > most) {
      int longest = 0;
      for (int k = 1; k < 3; ++k) longest = cells[k] > cells[longest] ? k : longest;
      std::uint64_t power = 1;
      while (2 * power < cells[longest]) power *= 2;
      cells[longest] = power;
      l.mask[longest] = static_cast<std::uint32_t>(power - 1);
    }
    l.stride[0] = static_cast<std::uint32_t>(cells[0]);
    l.stride[1] = static_cast<std::uint32_t>(cells[0] * cells[1]);
    return static_cast<std::uint32_t>(cells[0] * cells[1] * cells[2]);
  }
};

}  // namespace collide::detail
