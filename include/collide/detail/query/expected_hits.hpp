/// \file
/// How many hits a query will have, told from a sample of its candidates: so that there is room for them at once, and
/// no second pass.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/geometry/aabb.hpp>
#include <collide/detail/geometry/swept_bounds.hpp>
#include <collide/detail/grid/triangle_cells.hpp>
#include <collide/detail/narrow_phase/traits.hpp>
#include <collide/detail/query/bin_spheres.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

/// Kernel body of a block of one thread: decides every `stride`-th of the pairs of a triangle and a sphere in its
/// cells.
template <class S, class NarrowPhase>
struct sample_hits {
  static constexpr int items = 4;
  static constexpr std::uint32_t stride = 256;

  mesh_view<S> mesh;
  spheres_in_cells<S> in;
  std::uint64_t* hits;  ///< of those that were decided

  struct nothing {};
  template <class>
  using scratch = nothing;

  template <class Block>
  void operator()(Block& block, nothing&) const {
    std::size_t const begin = block.index() * Block::items, end = smaller(begin + Block::items, mesh.size());
    // where the first one is differs from block to block, whatever these have in common
    std::uint32_t skip = static_cast<std::uint32_t>(block.index()) * 2654435769u >> 24;
    std::uint64_t found = 0;
    for (std::size_t t = begin; t < end; ++t) {
      if (in.boxes[t].is_empty()) continue;  // not finite
      auto const look_into = [&](std::uint32_t cell, std::uint32_t n) {
        std::uint32_t const first = in.ends[cell], size = in.ends[cell + n] - first;
        for (; skip < size; skip += stride) found += touches(first + skip, t);
        skip -= size;
      };
      for (int g = 0; g < in.grid_count; ++g) {
        each_range(
            in.grids[g], in.boxes[t], [&] { return mesh[t]; }, look_into);
      }
      look_into(in.everywhere, 1);
    }
    if (found != 0) fetch_add(hits, found);
  }

  /// How many there are in all, with so many in the sample: more than that is unlikely, and by half more all but
  /// impossible.
  static std::uint64_t all_of(std::uint64_t sampled) {
    double const n = static_cast<double>(sampled) + 1;
    return static_cast<std::uint64_t>(stride * (n + n / 16 + 3 * std::sqrt(n)));
  }

 private:
  bool touches(std::uint32_t place, std::size_t t) const {
    sphere<S> const here = in.spheres[place];
    if (!in.boxes[t].overlaps(here.centre, here.radius)) return false;
    if constexpr (is_discrete<NarrowPhase, S>) {
      return NarrowPhase::intersects(mesh[t], here);
    } else {
      return NarrowPhase::intersects(mesh[t], in.spheres.moving[place]);
    }
  }
};

}  // namespace collide::detail
