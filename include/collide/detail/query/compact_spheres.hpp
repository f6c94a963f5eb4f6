/// \file
/// Of the spheres of a query, those that may be near a triangle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <collide/detail/geometry/sphere_pack.hpp>
#include <collide/detail/grid/assign_grids.hpp>
#include <collide/detail/grid/occupancy.hpp>
#include <collide/detail/narrow_phase/intersects.hpp>
#include <collide/detail/narrow_phase/traits.hpp>

namespace collide::detail {

/// Lists the spheres that are inside a grid, or that no grid serves, in scratch memory.
template <class S, class NarrowPhase>
struct compact_spheres {
  static constexpr bool still = at_rest<NarrowPhase, S>;
  /// Whether a lane loads its first spheres before it is known how they are to be asked. Narrow phases that are not in
  /// stages have no registers left for that on CUDA.
  static constexpr bool loads_early = in_stages<NarrowPhase>::value;

  spheres_of<NarrowPhase, S> const& spheres;
  std::size_t blocks;  ///< that share the spheres

  /// How many spheres are placed, how many of them in no grid, because none serves them, and how many lanes have more.
  struct placement {
    std::uint32_t placed, unplaced, unfinished;
  };

  template <class Block>
  struct scratch {
    static constexpr std::uint32_t room = 2 * Block::lanes * Block::items;
    id placed[room];            ///< spheres inside a grid
    std::int8_t grid_of[room];  ///< and in which
    placement found;
  };

  /// Lanes take spheres in turn, some in a row at a time, of which those of neighbours are next to each other: where a
  /// lane begins, and how far it goes on in each turn.
  template <class Block>
  COLLIDE_HD_INLINE std::size_t first_of(Block const& block, int lane) const {
    constexpr auto beside = static_cast<std::size_t>(Block::row_lanes);
    auto const own = static_cast<std::size_t>(lane);
    return ((own / beside * blocks + block.index()) * beside + own % beside) * Block::items;
  }
  template <class Block>
  COLLIDE_HD_INLINE std::size_t turn() const {
    return blocks * Block::lanes * Block::items;
  }

  /// How many groups a lane places at most before all look up what they have found: where lanes work together, one that
  /// finds less than others would else go on alone.
  template <class Block>
  static constexpr std::uint32_t most_groups = Block::lanes > 1 ? 12 : std::numeric_limits<std::uint32_t>::max();

  /// Goes through a lane's spheres, from `next` on, as long as there is room; `place(first)` lists some and says how
  /// many.
  template <class Block, class Place>
  COLLIDE_HD_INLINE void place_many(std::size_t& next, Place const& place) const {
    constexpr std::uint32_t n = Block::items, room = scratch<Block>::room / Block::lanes;
    std::uint32_t placed = 0;
    for (std::uint32_t k = 0; k < most_groups<Block> && next < spheres.size() && placed + n <= room; ++k) {
      placed += place(next);
      next += turn<Block>();
    }
  }

  struct nothing {};
  /// Spheres that a lane loads before it needs them, if they rest.
  template <class Block>
  using group = std::conditional_t<still, sphere_batch<S, Block::items>, nothing>;

  /// The centres, where whole groups of them can be loaded at once; else null.
  template <class Block>
  COLLIDE_HD_INLINE S const* quads_of() const {
    if constexpr (still) {
      return spheres.size() < Block::items ? nullptr : group<Block>::quads_of(spheres);
    } else {
      return nullptr;
    }
  }

  /// Loads the group from `first` on; if not all of it is there, some others: ptxas 13.0 keeps in memory what it loads
  /// under a condition.
  template <class Block>
  COLLIDE_HD_INLINE void load_ahead([[maybe_unused]] group<Block>& own, [[maybe_unused]] S const* quads,
                                    [[maybe_unused]] std::size_t first) const {
    if constexpr (still) {
      if (quads != nullptr) own.load_quads(quads, first + Block::items <= spheres.size() ? first : 0);
    }
  }

  /// Lists those of a lane's spheres, from `next` on, that are in marked cells, as long as there is room. Where whole
  /// groups can be loaded at once, the next one is on its way while a group is marked. `own` is the first one if
  /// `loads_early`.
  template <class Block>
  COLLIDE_HD_INLINE void mark_many(Block& block, scratch<Block>& s, cell_marks<S> const& marks,
                                   bucket_lookup<S> const& near, std::size_t& next, [[maybe_unused]] S const* quads,
                                   [[maybe_unused]] group<Block>& own) const {
    if constexpr (still) {
      auto const mark = [&](typename cell_marks<S>::template places<Block::items> const& places, std::size_t first) {
        bool marked[Block::items];
        marks.mark(places, marked);
        return list_marked(block, s, marked, first);
      };
      auto const load_and_mark = [&](std::size_t first) {
        group<Block> some;
        some.load(spheres, first);
        return mark(marks.places_of(some.x, some.y, some.z), first);
      };
      if (quads == nullptr) {
        place_many<Block>(next, load_and_mark);
        return;
      }
      if (!loads_early) load_ahead<Block>(own, quads, next);
      place_many<Block>(next, [&](std::size_t first) {
        if (first + Block::items > spheres.size()) return load_and_mark(first);
        auto const places = marks.places_of(own.x, own.y, own.z);
        load_ahead<Block>(own, quads, first + turn<Block>());
        return mark(places, first);
      });
    } else {
      place_many<Block>(next, [&](std::size_t first) {
        if (first + Block::items > spheres.size()) return place_own(block, s, near, first);
        moving_batch<S, Block::items> own;
        own.load(spheres, first);
        bool marked[Block::items];
        bool const known = marks.mark_ways(own, marked);
        return known ? list_marked(block, s, marked, first) : place_own(block, s, near, first);
      });
    }
  }

  /// Lists those of a lane's spheres, from `first` on, that are marked; returns how many.
  template <class Block>
  COLLIDE_HD_INLINE std::uint32_t list_marked(Block& block, scratch<Block>& s, bool const (&marked)[Block::items],
                                              std::size_t first) const {
    constexpr int n = Block::items;
    std::uint32_t placed = 0;
    for (int k = 0; k < n; ++k) placed += marked[k];
    if (placed == 0) return 0;
    std::uint32_t place = block.add(s.found.placed, placed);
    for (int k = 0; k < n; ++k) {
      if (!marked[k]) continue;
      s.placed[place] = static_cast<id>(first) + static_cast<id>(k);
      s.grid_of[place++] = 0;
    }
    return placed;
  }

  /// Lists those of a lane's spheres from `first` on that are inside a grid or that no grid serves; returns how many.
  template <class Block>
  COLLIDE_HD_INLINE std::uint32_t place_own(Block& block, scratch<Block>& s, bucket_lookup<S> const& near,
                                            std::size_t first) const {
    constexpr int n = Block::items;
    lane_state<S, n, still> own;
    own.load(spheres, first);
    for (int g = 0; g < near.grid_count; ++g) own.place(near.grids[g], g);
    std::uint32_t placed = 0, unplaced = 0;
    for (int k = 0; k < n; ++k) {
      if constexpr (!still) {
        int const g = own.grid_number[k];
        if (g >= 0 && near.empty_in(near.grids[g], own.batch.ball(k))) own.grid_number[k] = bucket_lookup<S>::nowhere;
      }
      placed += own.grid_number[k] != bucket_lookup<S>::nowhere;
      unplaced += own.grid_number[k] == bucket_lookup<S>::everywhere;
    }
    if (placed == 0) return 0;
    if (unplaced != 0) block.add(s.found.unplaced, unplaced);
    std::uint32_t place = block.add(s.found.placed, placed);
    for (int k = 0; k < n; ++k) {
      if (own.grid_number[k] == bucket_lookup<S>::nowhere) continue;
      s.placed[place] = static_cast<id>(first) + static_cast<id>(k);
      s.grid_of[place++] = static_cast<std::int8_t>(own.grid_number[k]);
    }
    return placed;
  }
};

}  // namespace collide::detail
