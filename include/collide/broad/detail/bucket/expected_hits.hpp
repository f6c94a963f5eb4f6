/// \file
/// How many hits a query will have, told from a sample of its candidates: so that there is room for them at once, and
/// no second pass.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/bucket/bin_spheres.hpp>
#include <collide/broad/detail/bucket/triangle_group.hpp>
#include <collide/broad/detail/grid/triangle_cells.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/geometry/swept_bounds.hpp>
#include <collide/narrow/detail/traits.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// Kernel functor of a block of one thread: decides every `stride`-th of the pairs of a triangle and a sphere in its
/// cells.
template <class S, class NarrowPhase>
struct sample_hits {
  static constexpr int items = 4;
  static constexpr std::uint32_t stride = 256;

  spheres_in_cells<S> in;
  std::uint64_t* hits;  ///< of those that were decided

  struct nothing {};
  template <class>
  using scratch = nothing;

  template <class Block>
  void operator()(Block& block, nothing&) const {
    constexpr std::uint32_t n = triangle_group<S>::size;
    std::size_t const begin = block.index() * Block::items, end = min(begin + Block::items, in.mesh.mesh.size());
    // where the first one is differs from block to block, whatever these have in common
    std::uint32_t skip = static_cast<std::uint32_t>(block.index()) * 2654435769u >> 24;
    std::uint64_t found = 0;
    for (std::size_t first = begin; first < end; first += n) {
      if (in.groups[first / n].is_empty()) continue;
      triangle_group<S> group;
      multiversioned([&] { in.mesh.load(group, first / n); });
      for (std::uint32_t k = 0; k < n; ++k) found += sample(group, k, skip);
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
  /// How many of the sampled pairs of triangle `k` of a group are hits; `skip` is how many pairs come before the next.
  std::uint64_t sample(triangle_group<S> const& group, std::uint32_t k, std::uint32_t& skip) const {
    if (!group.has(k)) return 0;
    triangle_aabb<S> const around = group.box(k);
    std::uint64_t found = 0;
    auto const look_into = [&](std::uint32_t cell, std::uint32_t n) {
      std::uint32_t const first = in.ends[cell], size = in.ends[cell + n] - first;
      for (; skip < size; skip += stride) found += touches(first + skip, around, group[k]);
      skip -= size;
    };
    for (int g = 0; g < in.grid_count; ++g) {
      each_range(
          in.grids[g], around, [&] { return group[k]; }, look_into);
    }
    look_into(in.everywhere, 1);
    return found;
  }

  COLLIDE_COLD bool touches(std::uint32_t place, triangle_aabb<S> const& around, triangle<S> const& t) const {
    sphere<S> const here = in.spheres[place];
    if (!around.overlaps(here.centre, here.radius)) return false;
    if constexpr (is_discrete<NarrowPhase, S>) {
      return NarrowPhase::intersects(t, here);
    } else {
      return NarrowPhase::intersects(t, in.spheres.moving[place]);
    }
  }
};

}  // namespace collide::detail
