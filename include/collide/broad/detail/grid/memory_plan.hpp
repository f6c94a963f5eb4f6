/// \file
/// How many grids with how many cells a memory budget allows.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include <collide/broad/detail/grid/grid.hpp>
#include <collide/core/error.hpp>

namespace collide::detail {

/// Size of the table of `cells` cells: a list per cell, the number of all entries, and a bit per cell.
inline std::size_t table_size(std::size_t cells) { return cells + 1 + cells / 64; }

/// Entries are numbered with 32 bits, and a triangle that is small against the cells is in at most eight.
inline constexpr std::size_t max_entries = std::numeric_limits<std::uint32_t>::max();
inline constexpr std::size_t max_triangles_of_grid = max_entries / 8;

/// True if a build has at most `limit` triangles, and no more than a grid can have.
inline bool fits_grid(std::size_t triangles, std::size_t limit) {
  return triangles <= std::min(limit, max_triangles_of_grid);
}

/// Throws `error` if it has more.
inline void check_triangles(std::size_t triangles, std::size_t limit) {
  if (fits_grid(triangles, limit)) return;
  throw error("collide: bucket: " + std::to_string(triangles) + " triangles are more than " +
              std::to_string(std::min(limit, max_triangles_of_grid)) +
              ", the most of one build: build fewer at a time, with in_passes or on more ranks");
}

struct memory_plan {
  int grids = 0;
  std::uint32_t table_bits = 0;  ///< log2 of the number of cells per grid
  std::size_t entries = 0;       ///< of all grids, at most

  /// Plans as many of `wanted` grids as fit into `budget` bytes, of which `fixed` are taken, and then as many cells as
  /// fit. No grids if none fits. A budget of 0 is no limit. A given width of the cells may make many more entries. Few
  /// spheres do not pay for cells of each of many triangles, unless the grid serves many steps.
  static memory_plan make(std::size_t triangles, std::size_t spheres, int wanted, bool width_is_given,
                          std::size_t fixed, std::size_t budget, bool serves_steps = false) {
    std::uint32_t max_bits = 12;
    std::size_t const cells =
        std::max({serves_steps ? triangles : std::min(triangles, spheres),
                  std::min(4 * triangles, std::size_t{1} << 18), std::min(spheres / 16, 16 * triangles)});
    while (max_bits < 28 && (std::size_t{1} << max_bits) < cells) ++max_bits;
    for (int g = wanted; g > 0; --g) {
      auto const grids = static_cast<std::size_t>(g);
      std::size_t const min_entries = 8 * triangles * grids;
      if (min_entries > max_entries) continue;
      // the few spheres that use many triangles have, in the end, many pairs; the entries of several grids are counted
      // before there is memory for them
      bool const are_few = std::max(triangles, spheres) < 4096;
      std::size_t const of_triangle = are_few ? 12 : (spheres < triangles ? 48 : 16);
      std::size_t const chosen = of_triangle * triangles + spheres / (wanted > 1 ? 2 : 4) + (are_few ? 512 : 4096),
                        given = 1024 * triangles + (std::size_t{1} << 21);
      std::size_t const limit = std::min((width_is_given ? given : chosen) * grids, max_entries);
      for (std::uint32_t bits = max_bits; bits >= 6; --bits) {
        std::size_t const base = fixed + table_size(grids << bits) * sizeof(item_range);
        if (budget == 0) return {g, bits, limit};
        if (base + min_entries * sizeof(cell_item) > budget) continue;
        return {g, bits, std::min(limit, (budget - base) / sizeof(cell_item))};
      }
    }
    return {};
  }
};

}  // namespace collide::detail
