/// \file
/// Compaction: the spheres of a query that may be near a triangle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/broad/detail/grid/occupancy.hpp>
#include <collide/exact/detail/geometry/sphere_pack.hpp>
#include <collide/narrow/detail/traits.hpp>

namespace collide::detail {

/// Gathers the spheres that may be near a triangle, and which grid serves each, in scratch memory.
template <class S, class NarrowPhase>
struct compact_spheres {
  static constexpr bool still = is_discrete<NarrowPhase, S>;

  sphere_view_for<NarrowPhase, S> const& spheres;
  bucket_ref<S> const& grids;
  occupancy_view<S> const& occupancy;
  bool has_one_level;      ///< all spheres are in one grid of one level: `occupancy` knows of them
  std::size_t blocks;      ///< that share the spheres
  std::size_t run_length;  ///< so many threads of a block take packs next to each other

  /// How many spheres are active, how many of them no grid serves, and how many threads have more.
  struct counts {
    std::uint32_t active, ungridded, threads_with_more;
  };

  template <class Block>
  struct scratch {
    static constexpr std::uint32_t capacity = 2 * Block::num_threads * Block::items;
    id active[capacity];            ///< spheres near triangles
    std::int8_t grid_of[capacity];  ///< which grid serves each of them
    counts found;
  };

  /// Consecutive spheres of a thread.
  template <class Block>
  using pack = std::conditional_t<still, sphere_pack<S, Block::items>, moving_pack<S, Block::items>>;

  /// Threads take packs in turn, of which those of neighbours are next to each other: where a thread begins, and how
  /// far it goes on each time.
  template <class Block>
  COLLIDE_HD_INLINE std::size_t first_of(Block const& block, int thread_rank) const {
    auto const own = static_cast<std::size_t>(thread_rank);
    return ((own / run_length * blocks + block.index()) * run_length + own % run_length) * Block::items;
  }
  template <class Block>
  COLLIDE_HD_INLINE std::size_t stride() const {
    return blocks * Block::num_threads * Block::items;
  }

  /// Goes through a thread's spheres, from `next` on, as long as there is room.
  template <class Block>
  COLLIDE_HD_INLINE void compact(Block& block, scratch<Block>& s, std::size_t& next) const {
    auto const one_pack = [&](std::size_t first) {
      pack<Block> own;
      own.load(spheres, first);
      std::int8_t grid_of[Block::items];
      locate(own, first, grid_of);
      return append(block, s, grid_of, first);
    };
    if constexpr (still) {
      S const* const aligned = aligned_centres<Block>();
      if (aligned != nullptr) return compact_ahead(block, s, next, aligned, one_pack);
    }
    each_pack<Block>(next, one_pack);
  }

 private:
  static constexpr std::int8_t no_candidates = bucket_ref<S>::no_candidates, no_grid = bucket_ref<S>::no_grid;

  /// How many packs a thread goes through at most before all expand what they have found: where threads work together,
  /// one that finds less than others would else go on alone.
  template <class Block>
  static constexpr std::uint32_t max_packs = Block::num_threads > 1 ? 12 : std::numeric_limits<std::uint32_t>::max();

  /// Calls f(first) for a thread's packs, from `next` on, as long as there is room; f says how many spheres it has
  /// appended.
  template <class Block, class F>
  COLLIDE_HD_INLINE void each_pack(std::size_t& next, F const& f) const {
    constexpr std::uint32_t n = Block::items, capacity = scratch<Block>::capacity / Block::num_threads;
    std::uint32_t appended = 0;
    for (std::uint32_t k = 0; k < max_packs<Block> && next < spheres.size() && appended + n <= capacity; ++k) {
      appended += f(next);
      next += stride<Block>();
    }
  }

  /// The centres, if `occupancy` knows of all and whole packs can be loaded at once; else null.
  template <class Block>
  COLLIDE_HD_INLINE S const* aligned_centres() const {
    return has_one_level && spheres.size() >= Block::items ? pack<Block>::aligned_centres(spheres) : nullptr;
  }

  /// While the cells of a pack are asked whether they have triangles, the next pack is being read: or, where not all of
  /// that is there, some other, as ptxas 13.0 keeps in memory what it loads under a condition.
  template <class Block, class OnePack>
  COLLIDE_HD_INLINE void compact_ahead(Block& block, scratch<Block>& s, std::size_t& next, S const* aligned,
                                       OnePack const& one_pack) const {
    constexpr unsigned n = Block::items;
    pack<Block> own;
    auto const load_ahead = [&](std::size_t first) { own.load_xyz4(aligned, first + n <= spheres.size() ? first : 0); };
    load_ahead(next);
    each_pack<Block>(next, [&](std::size_t first) {
      if (first + n > spheres.size()) return one_pack(first);
      auto const places = occupancy.places_of(own.x, own.y, own.z);
      load_ahead(first + stride<Block>());
      bool near[n];
      occupancy.test_occupied(places, near);
      std::int8_t grid_of[n];
      for (unsigned k = 0; k < n; ++k) grid_of[k] = near[k] ? std::int8_t{0} : no_candidates;
      return append(block, s, grid_of, first);
    });
  }

  /// The grids of a pack's spheres, if they may be near a triangle.
  template <class Pack, unsigned N>
  COLLIDE_HD_INLINE void locate(Pack const& own, std::size_t first, std::int8_t (&grid_of)[N]) const {
    bool near[N];
    if (has_one_level && first + N <= spheres.size() && occupancy.test_occupied(own, near)) {
      for (unsigned k = 0; k < N; ++k) grid_of[k] = near[k] ? std::int8_t{0} : no_candidates;
      return;
    }
    grids.locate(own, grid_of);
  }

  /// Appends those of a pack's spheres that may be near a triangle; returns how many.
  template <class Block, unsigned N>
  COLLIDE_HD_INLINE std::uint32_t append(Block& block, scratch<Block>& s, std::int8_t const (&grid_of)[N],
                                         std::size_t first) const {
    std::uint32_t active = 0, ungridded = 0;
    for (unsigned k = 0; k < N; ++k) {
      active += grid_of[k] != no_candidates;
      ungridded += grid_of[k] == no_grid;
    }
    if (active == 0) return 0;
    if (ungridded != 0) block.add(s.found.ungridded, ungridded);
    std::uint32_t slot = block.add(s.found.active, active);
    for (unsigned k = 0; k < N; ++k) {
      if (grid_of[k] == no_candidates) continue;
      s.active[slot] = static_cast<id>(first) + static_cast<id>(k);
      s.grid_of[slot++] = grid_of[k];
    }
    return active;
  }
};

}  // namespace collide::detail
