/// \file
/// Which ranks have triangles where, as every rank knows it: those with triangles in each cell of a coarse grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <collide/core/moving_spheres.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/ranks/ranks.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide::detail {

/// A box around a sphere at all times of the step, with room for the rounding of any narrow phase at triangles of up to
/// `extent`; empty if the sphere can touch nothing.
template <class S>
COLLIDE_HD aabb<double> reach_of(sphere<S> const& s, vec3<S> const& displacement, double extent) {
  auto box = aabb<double>::empty();
  if (!is_valid_radius(s.radius) || !is_finite(s.centre) || !is_finite(displacement)) return box;
  constexpr S tiny = std::numeric_limits<S>::min();
  double const unit = static_cast<double>(ieee_traits<float>::unit_roundoff), r = static_cast<double>(s.radius);
  for (int k = 0; k < 3; ++k) {
    double const from = static_cast<double>(s.centre[k]), along = static_cast<double>(displacement[k]);
    double const size = (from < 0 ? -from : from) + (along < 0 ? -along : along);
    double const reached = r * (1 + 16 * unit) + 16 * unit * (extent + (along < 0 ? -along : along)) + 0x1p-48 * size +
                           2 * sqrt_rn(static_cast<double>(tiny));
    box.lower[k] = min(from, from + along) - reached;
    box.upper[k] = max(from, from + along) + reached;
  }
  return box;
}

/// A cube of cells, in levels of 1, 8, 64, ... cells, each of which halves the width of the one before.
class coarse_grid {
 public:
  static constexpr int finest = 5;
  static constexpr int cells_across = 1 << finest;

  /// Number of the first cell of a level, and with level finest + 1 of all cells.
  static COLLIDE_HD constexpr std::size_t first_of(int level) { return ((std::size_t{1} << (3 * level)) - 1) / 7; }
  static constexpr std::size_t size() { return first_of(finest + 1); }

  /// Over the boxes of all ranks: all call it, each with the box of its own triangles.
  template <class Ranks>
  void build(Ranks const& ranks, aabb<double> const& mine) {
    std::uint64_t bits[6], largest[6];
    for (int k = 0; k < 3; ++k) {
      bits[k] = to_ordered_bits(-mine.lower[k]);
      bits[3 + k] = to_ordered_bits(mine.upper[k]);
    }
    ranks.reduce(bits, largest, 6, reduction::max);
    for (int k = 0; k < 3; ++k) {
      bounds_.lower[k] = -from_ordered_bits<double>(largest[k]);
      bounds_.upper[k] = from_ordered_bits<double>(largest[3 + k]);
      double const half = bounds_.upper[k] / 2 - bounds_.lower[k] / 2, scale = half > 0 ? cells_across / half : 0;
      scale_[k] = is_finite(scale) ? scale : 0;
    }
  }

  COLLIDE_HD aabb<double> const& bounds() const { return bounds_; }

  /// How many cells of a level one unit is on an axis; 0 if all is in the first.
  double cells_on(int axis, int level) const { return scale_[axis] / (2 << (finest - level)); }

  /// True if the box reaches into the bounds.
  COLLIDE_HD bool meets(aabb<double> const& box) const {
    bool so = !bounds_.is_empty() && !box.is_empty();
    for (int k = 0; k < 3; ++k) so = so && box.lower[k] <= bounds_.upper[k] && bounds_.lower[k] <= box.upper[k];
    return so;
  }

  /// Calls f(cell) for up to 8 cells that cover what the box has of the bounds: those of the finest level of which it
  /// meets two along an axis. Two boxes that share a point have cells of which one is, or is part of, the other.
  template <class F>
  COLLIDE_HD void for_each_cell(aabb<double> const& box, F const& f) const {
    int low[3], high[3], level = finest;
    for (int k = 0; k < 3; ++k) {
      low[k] = cell(k, box.lower[k]);
      high[k] = cell(k, box.upper[k]);
    }
    while (high[0] - low[0] > 1 || high[1] - low[1] > 1 || high[2] - low[2] > 1) {
      --level;
      for (int k = 0; k < 3; ++k) {
        low[k] >>= 1;
        high[k] >>= 1;
      }
    }
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int x = low[0]; x <= high[0]; ++x) f(first_of(level) + place_of(x, y, z));
      }
    }
  }

  /// Place on a curve through all cells of the finest level, on which those near each other are mostly near, of the
  /// cell at the box's centre. It is below `places`.
  std::size_t place_at(aabb<double> const& box) const {
    if (box.is_empty()) return 0;
    int at[3];
    for (int k = 0; k < 3; ++k) at[k] = cell(k, box.lower[k] / 2 + box.upper[k] / 2);
    return place_of(at[0], at[1], at[2]);
  }
  static constexpr std::size_t places = std::size_t{1} << (3 * finest);

  static std::size_t cell_at(int level, int x, int y, int z) { return first_of(level) + place_of(x, y, z); }

  /// Number of the cell that contains a cell, which is not the first of all.
  static constexpr std::size_t parent_of(std::size_t cell) { return (cell - 1) / 8; }

 private:
  /// Rises with x.
  COLLIDE_HD int cell(int axis, double x) const {
    double const inside = min(max(x, bounds_.lower[axis]), bounds_.upper[axis]);
    double const at = (inside / 2 - bounds_.lower[axis] / 2) * scale_[axis];
    return at < cells_across - 1 ? static_cast<int>(at) : cells_across - 1;
  }

  /// Bits of the coordinates in turn: the eight cells of one cell follow each other.
  static COLLIDE_HD std::size_t place_of(int x, int y, int z) { return spread(x) | spread(y) << 1 | spread(z) << 2; }

  /// The bits of a coordinate, each followed by two zeros.
  static COLLIDE_HD std::size_t spread(int x) {
    static_assert(finest <= 8, "collide: a coordinate has eight bits at most");
    auto bits = static_cast<std::uint32_t>(x);
    bits = (bits | bits << 8) & 0x00f00fu;
    bits = (bits | bits << 4) & 0x0c30c3u;
    return (bits | bits << 2) & 0x249249u;
  }

  aabb<double> bounds_ = aabb<double>::empty();
  double scale_[3] = {};  ///< cells in half a unit
};

/// A `rank_map` as a plain value that a kernel takes: it reads the masks in memory of its space.
struct rank_lookup {
  coarse_grid grid;
  std::uint64_t const* masks;  ///< of each cell
  std::size_t words;           ///< of a mask
  /// A bit for each cell of each level: whether ranks other than this one are in it, or in one of the seven next to it
  /// that are no lower on any axis. Bit x of word first_row_of(level) + y + 2^level z is that of cell x, y, z.
  std::uint32_t const* others;

  /// Number of the first row of cells of a level in `others`, and with level finest + 1 of all rows.
  static COLLIDE_HD constexpr std::size_t first_row_of(int level) { return ((std::size_t{1} << (2 * level)) - 1) / 3; }

  /// Calls f(rank) for each rank that may have a triangle that meets the box, in rising order.
  template <class F>
  COLLIDE_HD void for_each_rank(aabb<double> const& box, F const& f) const {
    if (!grid.meets(box)) return;
    for (std::size_t w = 0; w < words; ++w) {
      std::uint64_t mask = 0;
      grid.for_each_cell(box, [&](std::size_t cell) { mask |= masks[cell * words + w]; });
      for (int r = static_cast<int>(64 * w); mask != 0; ++r, mask >>= 1) {
        if ((mask & 1) != 0) f(r);
      }
    }
  }
};

/// Says to which ranks a box goes. Each rank has a bit in each cell of the coarse grid that its triangles meet, that
/// has such a cell in it, or that is in such a cell. Takes 37,449 words of 8 bytes for every 64 ranks, and 5,460 bytes.
class rank_map {
 public:
  /// All ranks call it; mark(f) calls f(box) for the box of each triangle of this one.
  template <class Ranks, class Mark>
  void build(Ranks const& ranks, coarse_grid const& grid, Mark const& mark) {
    grid_ = grid;
    std::vector<std::uint64_t> mine, all;
    together(ranks, [&] {
      words_ = (static_cast<std::size_t>(ranks.size()) + 63) / 64;
      masks_.assign(coarse_grid::size() * words_, 0);
      mine.assign(bit_words, 0);
      all.resize(bit_words * static_cast<std::size_t>(ranks.size()));
      mark([&](aabb<double> const& box) {
        if (!box.is_empty()) grid_.for_each_cell(box, [&](std::size_t cell) { mine[cell / 64] |= bit(cell); });
      });
    });
    ranks.all_gather(mine.data(), bit_words * sizeof(std::uint64_t), all.data());
    for (std::size_t r = 0; r < all.size() / bit_words; ++r) {
      for (std::size_t w = 0; w < bit_words; ++w) {
        std::size_t cell = 64 * w;
        for (std::uint64_t bits = all[r * bit_words + w]; bits != 0; bits >>= 1, ++cell) {
          if ((bits & 1) != 0) masks_[cell * words_ + r / 64] |= bit(r);
        }
      }
    }
    std::vector<std::uint64_t> inherited;
    together(ranks, [&] { inherited = masks_; });
    for (std::size_t i = words_; i < masks_.size(); ++i) inherited[i] |= inherited[parent_word(i)];
    for (std::size_t i = masks_.size(); i-- > words_;) masks_[parent_word(i)] |= masks_[i];
    for (std::size_t i = 0; i < masks_.size(); ++i) masks_[i] |= inherited[i];
    together(ranks, [&] { find_others(static_cast<std::size_t>(ranks.rank())); });
  }

  coarse_grid const& grid() const { return grid_; }

  /// Calls f(rank) for each rank that may have a triangle that meets the box, in rising order.
  template <class F>
  void for_each_rank(aabb<double> const& box, F const& f) const {
    rank_lookup{grid_, masks_.data(), words_, others_.data()}.for_each_rank(box, f);
  }

  /// The masks in memory of a space that cannot read the host's.
  struct lookup_memory {
    buffer<std::uint64_t> masks;
    buffer<std::uint32_t> others;
  };
  /// For kernels of a space, valid until the map is built again.
  template <class Space>
  rank_lookup lookup(Space const& space, lookup_memory& memory) const {
    return {grid_, in_space(space, masks_, memory.masks), words_, in_space(space, others_, memory.others)};
  }

 private:
  static constexpr std::size_t bit_words = (coarse_grid::size() + 63) / 64;

  static constexpr std::uint64_t bit(std::size_t i) { return std::uint64_t{1} << (i % 64); }
  std::size_t parent_word(std::size_t i) const { return coarse_grid::parent_of(i / words_) * words_ + i % words_; }

  /// True if ranks other than `self` are in a cell.
  bool has_others(std::size_t cell, std::size_t self) const {
    std::uint64_t others = 0;
    for (std::size_t w = 0; w < words_; ++w) others |= masks_[cell * words_ + w] & ~(w == self / 64 ? bit(self) : 0);
    return others != 0;
  }

  void find_others(std::size_t self) {
    static_assert(coarse_grid::cells_across <= 32, "collide: a row of cells has a word");
    others_.clear();
    for (int level = 0; level <= coarse_grid::finest; ++level) {
      int const across = 1 << level;
      for (int z = 0; z < across; ++z) {
        for (int y = 0; y < across; ++y) {
          std::uint32_t row = 0;
          for (int x = 0; x < across; ++x) {
            if (has_others(coarse_grid::cell_at(level, x, y, z), self)) row |= std::uint32_t{1} << x;
          }
          others_.push_back(row | row >> 1);
        }
      }
      std::uint32_t* const rows = others_.data() + rank_lookup::first_row_of(level);
      for (int i = 0; i < across * across; ++i) {  // those that follow are as they were
        if ((i + 1) % across != 0) rows[i] |= rows[i + 1];
      }
      for (int i = 0; i < across * (across - 1); ++i) rows[i] |= rows[i + across];
    }
  }

  coarse_grid grid_;
  std::vector<std::uint64_t> masks_;   ///< of each cell
  std::size_t words_ = 1;              ///< of a mask
  std::vector<std::uint32_t> others_;  ///< of each row of cells
};

}  // namespace collide::detail
