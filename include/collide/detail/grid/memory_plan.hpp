/// \file
/// How many grids with how many cells a memory budget allows.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/detail/grid/grid.hpp>

namespace collide::detail {

/// Size of the table of `cells` cells: a list per cell, the number of all entries, and a bit per cell.
inline std::size_t table_size(std::size_t cells) { return cells + 1 + cells / 64; }

/// The grids that are made.
struct memory_plan {
  int grids = 0;
  std::uint32_t table_bits = 0;  ///< log2 of the number of cells per grid
  float entry_limit = 0;         ///< per grid

  /// As many of `wanted` grids as fit into `budget` bytes, of which `fixed` are taken, and then as many cells. No grids
  /// if none fits. A budget of 0 is no limit. A triangle is in at most `cells_per_triangle` cells of a grid.
  static memory_plan make(std::size_t triangles, int wanted, std::size_t cells_per_triangle, std::size_t fixed,
                          std::size_t budget) {
    constexpr std::size_t id_limit = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t most_bits = 12;
    while (most_bits < 28 && (std::size_t{1} << most_bits) < 4 * triangles) ++most_bits;
    for (int g = wanted; g > 0; --g) {
      auto const grids = static_cast<std::size_t>(g);
      std::size_t const entries = cells_per_triangle * triangles * grids;
      if (entries > id_limit) continue;
      for (std::uint32_t bits = most_bits; bits >= 6; --bits) {
        std::size_t const base = fixed + table_size(grids << bits) * sizeof(item_range);
        std::size_t most_entries = std::min(512 * triangles + (std::size_t{1} << 20), id_limit / grids);
        if (budget != 0) {
          if (base + entries * sizeof(cell_item) > budget) continue;
          most_entries = std::min(most_entries, (budget - base) / (grids * sizeof(cell_item)));
        }
        return {g, bits, 0.99f * static_cast<float>(most_entries)};
      }
    }
    return {};
  }
};

}  // namespace collide::detail
