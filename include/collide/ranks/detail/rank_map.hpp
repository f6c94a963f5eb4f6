/// \file
/// Which ranks have triangles where, as every rank knows it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/ranks/detail/coarse_grid.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide::detail {

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
