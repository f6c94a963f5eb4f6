/// \file
/// Which cells triangles look into, a bit for each, on the CPU.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/bucket/triangle_order.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// Kernel functor of `for_each` over groups of triangles: sets a bit for every cell that a triangle looks into, and
/// perhaps for some more.
template <class S>
struct mark_occupied_cells {
  grouped_mesh<S> mesh;
  triangle_aabb<S> const* groups;
  grid<S> const* grids;
  int grid_count;
  std::uint32_t* occupied;

  void operator()(std::size_t i) const {
    if (groups[i].is_empty()) return;
    std::uint32_t each = 0;  // bits of grids for which a triangle is not small
    for (int g = 0; g < grid_count; ++g) {
      if (!is_small(groups[i], grids[g])) {
        each |= 1u << g;
        continue;
      }
      each_range_of_group(grids[g], groups[i], [&](std::uint32_t cell, std::uint32_t count) { mark(cell, count); });
    }
    if (each != 0) mark_each(i, each);
  }

 private:
  void mark_each(std::size_t i, std::uint32_t some) const {
    triangle_group<S> group;
    multiversioned([&] { mesh.load(group, i); });
    for (int g = 0; g < grid_count; ++g) {
      if ((some >> g & 1) == 0) continue;
      for (std::uint32_t k = 0; k < triangle_group<S>::size; ++k) {
        if (!group.has(k)) continue;
        each_range(
            grids[g], group.box(k), [&] { return group[k]; },
            [&](std::uint32_t cell, std::uint32_t count) { mark(cell, count); });
      }
    }
  }

  void mark(std::uint32_t first, std::uint32_t n) const {
    for (std::uint32_t const end = first + n; first < end;) {
      std::uint32_t const next = min((first / 32 + 1) * 32, end);
      std::uint32_t const bits = 0xffffffffu >> (32 - (next - first)) << first % 32;
      if ((load_relaxed(occupied + first / 32) & bits) != bits) fetch_or(occupied + first / 32, bits);
      first = next;
    }
  }
};

}  // namespace collide::detail
