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
/// Where a box around two triangles that follow each other is hardly larger than that of one, as in most meshes, they
/// are put into the cells together (CUDA): half of the entries. An entry is the number of such a pair then. Beside it
/// is which part of the cell the box covers, to a fifteenth of the cell's width, so that most triangles of a cell
/// that are not near a sphere in it are left out before anything else of them is read.
///
/// The rounding: cell coordinates are floor((x - lower) * inverse_width), a monotone function, so rounding alone cannot
/// separate a centre from a box that contains it; nor from the part of a cell that it covers. The slack of 64 units in
/// the last place of the largest coordinate covers the rounding of the box itself and a compiler that reassociates. The
/// reach is dilated by 4 units of float too, the coarsest arithmetic of a narrow phase, so that none of its hits is
/// lost here, right or wrong. See docs/numerics.md.
#pragma once

#include <collide/detail/grid/mesh_statistics.hpp>

namespace collide::detail {

inline constexpr int max_levels = 16;
inline constexpr int max_grids = 8;

/// A range of cell coordinates per axis.
struct cell_range {
  std::uint32_t lower[3], upper[3];
};

/// The part of a cell that a box covers, and what may be in it. A cell is 15 steps wide on each axis: 14 sixteenths of
/// its width, and the rest. Both are six numbers of 5 bits, two for each axis, such that a sum tells whether they meet:
/// those of a side of the box, at most 17 and 14, add up to 16 or more unless all that may be there is beyond it.
struct cell_part {
  static constexpr std::uint32_t first = 1, last = 15;   ///< steps
  static constexpr std::uint32_t before = 0;             ///< in place of a first step: begins in a cell before
  static constexpr std::uint32_t sides = 0x21084210;     ///< 16 in all numbers
  static constexpr std::uint32_t whole = 0x1ef7c631;     ///< a box that covers the cell, and begins before it
  static constexpr std::uint32_t anywhere = 0x1ef7b9ce;  ///< what is everywhere in the cell

  /// The step at a fraction of a cell.
  template <class S>
  static COLLIDE_HD_INLINE std::uint32_t step_at(S fraction) {
    auto const sixteenths = static_cast<std::uint32_t>(static_cast<std::int32_t>(fraction * S(16)));
    return smaller(sixteenths, last - first) + first;
  }

  /// A box from the step `from` to the step `to` of an axis; to be united by `|` with the other axes.
  static COLLIDE_HD_INLINE std::uint32_t covered(std::uint32_t from, std::uint32_t to, int axis) {
    return (17 - from) << 5 * axis | to << (5 * axis + 15);
  }

  /// What is from the step `from` to the step `to` of an axis; to be united with the other axes.
  static COLLIDE_HD_INLINE std::uint32_t at(std::uint32_t from, std::uint32_t to, int axis) {
    return (to - 1) << 5 * axis | (16 - from) << (5 * axis + 15);
  }

  static COLLIDE_HD_INLINE bool meets(std::uint32_t part, std::uint32_t place) {
    return ((part + place) & sides) == sides;
  }

  /// An axis, to be united with others.
  static COLLIDE_HD_INLINE std::uint32_t axis(int k) { return 1u << 5 * k; }

  /// Whether the box begins in a cell before on one of these axes.
  static COLLIDE_HD_INLINE bool begins_before(std::uint32_t part, std::uint32_t axes) {
    return (part >> 4 & part & axes) != 0;  // 17, the only odd number from 16 on
  }
};

/// A cell, and a part of it or a place in it.
struct covered_cell {
  std::uint32_t number, part;
};

/// What is in a cell: a triangle, or a pair of them, and the part of the cell that its dilated box covers.
struct alignas(8) cell_entry {
  id number;
  std::uint32_t part;
};

/// Cells of one width.
template <class S>
struct grid_level {
  S inverse_width;
  S largest;                ///< the largest dilated extent of a triangle of this level
  std::uint32_t mask[3];    ///< where cell coordinates wrap: a power of two - 1
  std::uint32_t stride[2];  ///< how far the cells of neighbours in y and in z are apart
  std::uint32_t first;      ///< number of the first cell

  /// How many cells fit below an offset from the grid's lower end; from 0 to 2^30.
  COLLIDE_HD_INLINE std::uint32_t coordinate(S offset) const { return whole(cells_below(offset)); }

  /// The same, and the step of the next cell that it ends in.
  COLLIDE_HD_INLINE std::uint32_t coordinate(S offset, std::uint32_t& step) const {
    S const cells = cells_below(offset);
    std::uint32_t const full = whole(cells);
    step = cell_part::step_at(cells - static_cast<S>(full));
    return full;
  }

  /// The same of an offset that is not above the grid's upper end; of others, any number.
  COLLIDE_HD_INLINE std::uint32_t coordinate_inside(S offset) const {
#if defined(__CUDA_ARCH__)
    if constexpr (sizeof(S) == 4) return __float2uint_rz(mul(offset, inverse_width));  // 0 of what is less
#endif
    return coordinate(offset);
  }

  /// The cell that holds a point inside the grid, whose lower end this is, and the place of the point in it.
  COLLIDE_HD_INLINE covered_cell place_of(vec3<S> const& p, S const (&lower)[3]) const {
    std::uint32_t cell[3], place = 0;
    for (int k = 0; k < 3; ++k) {
      std::uint32_t step;
      cell[k] = coordinate(p[k] - lower[k], step);
      place |= cell_part::at(step, step, k);
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
  COLLIDE_HD_INLINE S cells_below(S offset) const {
    return smaller(larger(S(0), mul(offset, inverse_width)), S(1 << 30));
  }

  /// By way of a signed integer, for which all processors have an instruction.
  static COLLIDE_HD_INLINE std::uint32_t whole(S x) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(x)); }
};

/// What a grid is, but for its levels.
template <class S>
struct grid_frame {
  S reach;     ///< serves spheres of radius up to this
  S dilation;  ///< reach and slack: how far a triangle's box is dilated
  S width;     ///< of the cells of the finest level
  S lower[3];  ///< of the dilated mesh
  S upper[3];
  int levels;           ///< 0 if no triangle is in the grid
  std::uint32_t bits;   ///< log2 of how many triangles an entry is: 2^bits, from number entry * 2^bits on; at most 1
  std::uint32_t cells;  ///< how many there are, of all levels

  /// Cell coordinate, before wrapping, of the coordinate `x` on an axis. Monotone in x; ends at 2^30.
  COLLIDE_HD_INLINE std::uint32_t coordinate(grid_level<S> const& l, S x, int axis) const {
    return l.coordinate(x - lower[axis]);
  }

  /// The cells that a triangle with this box is put into, at most one whole turn of the level on each axis, and the
  /// steps in the first and the last of them from and up to which the dilated box reaches.
  COLLIDE_HD_INLINE cell_range cells_of(grid_level<S> const& l, box<S> const& b, std::uint32_t (&from)[3],
                                        std::uint32_t (&to)[3]) const {
    cell_range r;
    for (int k = 0; k < 3; ++k) {
      r.lower[k] = l.coordinate(b.lower[k] - dilation - lower[k], from[k]);
      r.upper[k] = l.coordinate(b.upper[k] + dilation - lower[k], to[k]);
      bool const turns = r.upper[k] - r.lower[k] > l.mask[k];  // then a cell may be the first and a later one, too
      from[k] = turns ? cell_part::before : from[k];
      to[k] = turns ? cell_part::last : to[k];
      r.upper[k] = turns ? r.lower[k] + l.mask[k] : r.upper[k];
    }
    return r;
  }
};

/// The grid for spheres up to one radius.
template <class S>
struct grid : grid_frame<S> {
  using grid_frame<S>::levels, grid_frame<S>::dilation, grid_frame<S>::coordinate;

  grid_level<S> level[max_levels];

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

  /// The same, and the place of the point in it.
  COLLIDE_HD_INLINE covered_cell place_of(grid_level<S> const& l, vec3<S> const& p) const {
    return l.place_of(p, this->lower);
  }

  /// The cells that a triangle is put into: at most one whole turn of the level on each axis.
  COLLIDE_HD_INLINE cell_range cells_of(grid_level<S> const& l, box<S> const& b) const {
    cell_range r = range_of(l, b);
    for (int k = 0; k < 3; ++k) r.upper[k] = smaller(r.upper[k], r.lower[k] + l.mask[k]);
    return r;
  }

  /// Calls f(cells, m) with m of at most N cells at a time and what the box covers of them, for every `parts`-th of the
  /// cells that a triangle with this box is put into, from the `part`-th on. `frame` and `finest` are this grid's.
  template <int N, class F>
  COLLIDE_HD_INLINE void each_cells(grid_frame<S> const& frame, grid_level<S> const& finest, box<S> const& b,
                                    std::uint32_t part, std::uint32_t parts, F const& f) const {
    grid_level<S> l = finest;
    if (frame.levels > 1) l = level_of(b);
    std::uint32_t from[3], to[3];
    cell_range const r = frame.cells_of(l, b, from, to);
    std::uint32_t const nx = r.upper[0] - r.lower[0] + 1, ny = r.upper[1] - r.lower[1] + 1,
                        nz = r.upper[2] - r.lower[2] + 1;
    auto const covered = [&](std::uint32_t i, std::uint32_t cells, int axis) {
      return cell_part::covered(i == 0 ? from[axis] : cell_part::before, i + 1 == cells ? to[axis] : cell_part::last,
                                axis);
    };
    std::uint32_t const n = frame.levels == 0 || b.is_empty() ? 0 : nx * ny * nz;
    for (std::uint32_t i = part; i < n; i += N * parts) {
      covered_cell cells[N];
      std::uint32_t m = 0;
      for (std::uint32_t k = 0; k < N; ++k) {
        std::uint32_t const number = i + k * parts, rows = number / nx;
        std::uint32_t const x = number % nx, y = rows % ny, z = rows / ny;
        cells[k].number = l.row(r.lower[1] + y, r.lower[2] + z) + ((r.lower[0] + x) & l.mask[0]);
        cells[k].part = covered(x, nx, 0) | covered(y, ny, 1) | covered(z, nz, 2);
        m += number < n ? 1u : 0u;
      }
      f(cells, m);
    }
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

/// The triangles of a cell.
struct alignas(8) cell_list {
  std::uint32_t count;
  std::uint32_t end;  ///< of its entries; while they are written, of those that are
};

/// Kernel body of a block per grid: chooses widths, levels and table sizes from the summary of the mesh. A single
/// lane's work of some microseconds, so that a build on the device need not wait for the host; much of that is fetching
/// instructions, so the fewer the better. Other blocks empty the lists of the cells meanwhile.
template <class S>
struct plan_grid {
  static constexpr int items = 1;

  mesh_summary<S> const* summary;
  grid<S>* grids;
  S reaches[max_grids];
  S cell_width;              ///< asked for; 0 = choose
  S usual_span;              ///< how many cells wide most triangles are at most, if the width is not asked for
  float entry_limit;         ///< how many entries a grid may have, if the width is asked for
  std::uint32_t table_bits;  ///< log2 of the number of cells per grid
  bool pairs;                ///< triangles may be put into the cells two at a time
  int grid_count;
  cell_list* lists;
  std::size_t list_count;  ///< to be emptied

  static constexpr std::size_t lists_of_lane = 16;

  template <class Block>
  std::size_t blocks() const {
    constexpr std::size_t per_block = Block::lanes * lists_of_lane;
    return static_cast<std::size_t>(grid_count) + (list_count + per_block - 1) / per_block;
  }

  template <class Block>
  struct scratch {
    typename Block::template single<mesh_summary<S>> seen;
    int medians[2];
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    if (block.index() >= static_cast<std::size_t>(grid_count)) {
      constexpr std::size_t per_block = Block::lanes * lists_of_lane;
      std::size_t const first = (block.index() - static_cast<std::size_t>(grid_count)) * per_block;
      std::size_t const end = smaller(first + per_block, list_count);
      block.each([&](int lane) {
        COLLIDE_ROLLED
        for (std::size_t i = first + static_cast<std::size_t>(lane); i < end; i += Block::lanes) lists[i] = {0, 0};
      });
      return;
    }
    mesh_summary<S> const& seen = block.near(s.seen, *summary);
    block.each([&](int lane) {
      for (int b = lane; b <= (pairs ? 1 : 0); b += Block::lanes) s.medians[b] = median(seen.extents[b]);
    });
    block.each([&](int lane) {
      if (lane != 0) return;
      auto& g = grids[block.index()];
      grid_frame<S> const frame = plan(block.index(), seen, s.medians, g.level);
      static_cast<grid_frame<S>&>(g) = frame;
    });
  }

 private:
  /// Sets the levels and returns the rest; `medians` are the bins that half of the sizes do not exceed.
  COLLIDE_HD grid_frame<S> plan(std::size_t i, mesh_summary<S> const& seen, int const* medians,
                                grid_level<S>* levels) const {
    auto const* const extents = seen.extents;
    grid_frame<S> g{};
    g.reach = reaches[i];
    levels[0] = {};          // is read before it is known whether there is one
    if (extents->empty()) {  // no finite triangle: a box that contains nothing
      for (int k = 0; k < 3; ++k) {
        g.lower[k] = 1;
        g.upper[k] = -1;
      }
      return g;
    }
    S far = g.reach;
    for (int k = 0; k < 3; ++k) {
      g.lower[k] = seen.lower_of(k);
      g.upper[k] = seen.upper_of(k);
      far = larger(far, larger(abs_of(g.lower[k]), abs_of(g.upper[k])));
    }
    g.dilation =
        g.reach * (1 + 4 * S(format<float>::unit)) + 64 * format<S>::unit * far + 64 * std::numeric_limits<S>::min();
    for (int k = 0; k < 3; ++k) {
      g.lower[k] -= g.dilation;
      g.upper[k] += g.dilation;
    }

    // pairs, if they are hardly larger than triangles, also the largest: in all grids or in none, whatever their reach
    S const least = 2 * reaches[grid_count - 1];
    auto const hardly_larger = [&](int bin, int than) { return size(bin) + least <= S(1.25) * (size(than) + least); };
    bool const alike = pairs && hardly_larger(extents[1].last(), extents[0].last());
    g.bits = alike && hardly_larger(medians[1], medians[0]) ? 1 : 0;
    size_histogram const& sizes = extents[g.bits];
    int const middle = medians[g.bits];
    S extent = 0;
    for (int k = 0; k < 3; ++k) extent = larger(extent, g.upper[k] - g.lower[k]);
    constexpr S end = std::numeric_limits<S>::max() / 16;
    int const top = sizes.last();
    S const tallest = margin * size(g, top);
    if (!(extent < end && far < end &&
          tallest < end)) {  // the range of S does not suffice: a grid that serves no sphere
      g.reach = -1;
      return g;
    }
    // from this width on, cell coordinates are exact enough for `margin`
    S const narrowest = larger(96 * format<S>::unit * extent, 64 * std::numeric_limits<S>::min());
    // the largest must fit also when the quotient is rounded down
    S const usual = div(smaller(tallest, 2 * margin * size(g, middle)), usual_span) * (1 + 4 * format<S>::unit);
    S width = larger(narrowest, cell_width > 0 ? cell_width : usual);
    S const span = cell_width > 0 ? span_for(g, width, sizes) : usual_span;
    // half of the cells for the finest level, the rest for the others together; all if there are no others
    std::uint32_t const first_cell = static_cast<std::uint32_t>(i) << table_bits;
    int bin = sizes.first();
    while (bin <= top) {
      if (g.levels + 1 == max_levels) width = larger(width, tallest / span);
      while (margin * size(g, bin) > width * span) width *= 2;
      int next = bin + 1;
      while (next <= top && (sizes.counts[next] == 0 || margin * size(g, next) <= width * span)) ++next;
      bool const last = next > top;
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
    return g;
  }

 private:
  /// Cells are wider than the largest triangle of their level by this factor, so that rounding cannot make it touch
  /// more than `span` + 1 of them on an axis.
  static constexpr S margin = S(1.125);

  static COLLIDE_HD S abs_of(S x) { return x < 0 ? -x : x; }

  /// The largest extent in a bin of the histogram, and the largest dilated one.
  static COLLIDE_HD S size(int bin) { return S(bin_end(static_cast<std::uint32_t>(bin))); }
  static COLLIDE_HD S size(grid_frame<S> const& g, int bin) { return size(bin) + 2 * g.dilation; }

  static COLLIDE_HD int median(size_histogram const& sizes) {
    if (sizes.empty()) return 0;
    std::uint64_t total = 0;
    COLLIDE_ROLLED
    for (int b = sizes.first(); b <= sizes.last(); ++b) total += sizes.counts[b];
    int b = sizes.first();
    COLLIDE_ROLLED
    for (std::uint64_t below = sizes.counts[b]; 2 * below < total; below += sizes.counts[++b]) {
    }
    return b;
  }

  /// How many cells of the width asked for a triangle may span before it goes to a wider level: as many as the limit on
  /// entries allows, at most 64.
  COLLIDE_HD S span_for(grid_frame<S> const& g, S width, size_histogram const& sizes) const {
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

  /// Gives each axis of the level as many cells as the grid has, and if that is more than `most` in all, cuts the
  /// longest axes down to powers of two, where coordinates wrap. Returns the number of cells.
  static COLLIDE_HD std::uint32_t dimension(grid_frame<S> const& g, grid_level<S>& l, std::uint64_t most) {
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

/// Visits the cells of triangles in all grids: the common part of counting and filling. `Parts` threads, next to each
/// other, share the cells of a triangle, because each cell's counter takes its time to answer, and counters next to
/// each other answer together.
template <class S, int Parts>
struct grid_insertion {
  mesh_view<S> mesh;
  triangle_box<S> const* boxes;  ///< null if there was no room for them
  grid<S> const* grids;
  int grid_count;

  /// How many threads there are.
  std::size_t size() const { return mesh.size() * Parts; }

  static constexpr int together = Parts > 1 ? 4 : 1;  ///< cells that a thread asks at a time

  /// Calls f(cells, n, entry) for all cells that are this thread's, n of at most `together` at a time.
  template <class F>
  COLLIDE_HD_INLINE void each_cells(std::size_t thread, F const& f) const {
    auto const number = static_cast<id>(thread / Parts);
    for (int g = 0; g < grid_count; ++g) {
      asked_for need{grids[g], grids[g].level[0], box_at(number), {}};
      need.other = need.own;
      if ((Parts > 1 && boxes != nullptr) || need.frame.bits != 0)
        need.other = box_at(smaller<id>(number ^ 1, static_cast<id>(mesh.size()) - 1));
      read_at_once(need);
      // the threads of the triangles of an entry share its cells; the last triangle may be alone
      std::uint32_t const bits = need.frame.bits;
      id const entry = number >> bits;
      std::size_t const first = std::size_t{entry} << bits;
      bool const two = bits != 0 && first + 1 < mesh.size();
      std::uint32_t const parts = two ? 2 * Parts : Parts;
      std::uint32_t const part = static_cast<std::uint32_t>(thread % Parts) + Parts * (number - (entry << bits));
      box<S> const b = two ? typename box<S>::unite{}(need.own, need.other) : need.own;
      grids[g].template each_cells<together>(
          need.frame, need.finest, b, part, parts,
          [&](covered_cell const(&cells)[together], std::uint32_t n) { f(cells, n, entry); });
    }
  }

 private:
  /// What a thread reads before it asks for cells: nothing of that depends on other parts of it.
  struct asked_for {
    grid_frame<S> frame;
    grid_level<S> finest;
    box<S> own, other;  ///< of the triangle, and of the one that it is a pair with, if it is
  };

  COLLIDE_HD_INLINE box<S> box_at(std::size_t i) const {
    triangle_box<S> const b = boxes != nullptr ? boxes[i] : triangle_box_of(mesh[i]);
    return b;
  }
};

/// Kernel body of `for_each` over an insertion's threads: counts the entries of each cell.
template <class S, int Parts>
struct count_entries {
  grid_insertion<S, Parts> insertion;
  cell_list* cells;
  COLLIDE_HD void operator()(std::size_t thread) const {
    constexpr std::uint32_t together = grid_insertion<S, Parts>::together;
    insertion.each_cells(thread, [&](auto const& some, std::uint32_t n, id) {
      for (std::uint32_t k = 0; k < together; ++k) {
        if (k < n) fetch_add(&cells[some[k].number].count, 1u);
      }
    });
  }
};

/// Kernel body: finds a place for the entries of each cell, and sets a bit for every cell that has some. Which cell's
/// come first is open; those of cells next to each other are next to each other, but for the ends of blocks.
template <class S>
struct allocate_entries {
  static constexpr int items = 8;  ///< cells of a lane: their bits are a byte

  grid<S> const* grids;
  std::uint32_t table_bits;
  std::size_t cell_count;  ///< of all grids
  cell_list* cells;        ///< aligned to 16 bytes
  std::uint8_t* occupied;
  std::uint32_t* total;  ///< 0 at first

  template <class Block>
  struct scratch {
    std::uint32_t sums[Block::lanes];
    std::uint32_t begin;
    typename Block::scan_scratch scan;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::items % items == 0, "collide: bits of cells are written byte by byte");
    constexpr auto n = static_cast<std::size_t>(Block::items);
    std::size_t const first = block.index() * Block::lanes * n;
    std::size_t const table = std::size_t{1} << table_bits;
    // a part of the table that the grid does not need; its lists are read all the same, to wait for both at once
    bool const needless = table >= Block::lanes * n && (first & (table - 1)) >= grids[first >> table_bits].cells;
    typename Block::template per_lane<counts_of<Block>> own;
    auto const first_of = [&](int lane) { return first + static_cast<std::size_t>(lane) * n; };
    block.each([&](int lane) {
      std::uint32_t sum = 0;
      for (std::size_t k = 0; k < n; k += 2) {
        std::size_t const c = first_of(lane) + k;
        auto const [a, b] = c < cell_count ? two_at(c) : two_lists{};
        own[lane].counts[k] = a.count;
        own[lane].counts[k + 1] = b.count;
        sum += a.count + b.count;
      }
      s.sums[lane] = sum;
    });
    if (needless) return;
    std::uint32_t const sum = block.scan(s.scan, s.sums, Block::lanes);
    block.each([&](int lane) {
      if (lane == 0) s.begin = fetch_add(total, sum);
    });
    block.each([&](int lane) {
      std::uint32_t begin = s.begin + s.sums[lane];
      for (std::size_t k = 0; k < n; k += items) {
        std::size_t const c = first_of(lane) + k;
        if (c >= cell_count) break;
        std::uint32_t bits = 0;
        for (std::uint32_t i = 0; i < items; i += 2) {
          std::uint32_t const a = own[lane].counts[k + i], b = own[lane].counts[k + i + 1];
          two_at(c + i) = {{a, begin}, {b, begin + a}};
          begin += a + b;
          bits |= ((a != 0 ? 1u : 0u) | (b != 0 ? 2u : 0u)) << i;
        }
        occupied[c / items] = static_cast<std::uint8_t>(bits);
      }
    });
  }

 private:
  /// What a lane reads and writes at once.
  struct alignas(16) two_lists {
    cell_list a, b;
  };
  COLLIDE_HD_INLINE two_lists& two_at(std::size_t cell) const { return reinterpret_cast<two_lists*>(cells)[cell / 2]; }

  template <class Block>
  struct counts_of {
    std::uint32_t counts[Block::items];
  };
};

/// Kernel body of `for_each` over an insertion's threads: writes the entries.
template <class S, int Parts>
struct fill_entries {
  grid_insertion<S, Parts> insertion;
  cell_list* cells;
  cell_entry* entries;
  std::size_t capacity;
  COLLIDE_HD void operator()(std::size_t thread) const {
    constexpr std::uint32_t together = grid_insertion<S, Parts>::together;
    insertion.each_cells(thread, [&](auto const& some, std::uint32_t n, id entry) {
      std::uint32_t slots[together];
      for (std::uint32_t k = 0; k < together; ++k) {
        if (k < n) slots[k] = fetch_add(&cells[some[k].number].end, 1u);
      }
      for (std::uint32_t k = 0; k < together; ++k) {
        if (k < n && slots[k] < capacity) entries[slots[k]] = {entry, some[k].part};
      }
    });
  }
};

}  // namespace collide::detail
