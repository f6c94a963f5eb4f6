/// \file
/// From spheres to the entries of their cells, and to candidates.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/detail/geometry/swept_bounds.hpp>
#include <collide/detail/grid/grid_ref.hpp>
#include <collide/detail/grid/occupancy.hpp>
#include <collide/detail/grid/swept_cells.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/detail/query/compact_spheres.hpp>

namespace collide::detail {

/// Spreads the entries of the spheres' cells over the lanes, and tests those that meet.
template <class S, class NarrowPhase, class Sink>
struct expand_cells {
  static constexpr bool still = at_rest<NarrowPhase, S>;
  using compact = compact_spheres<S, NarrowPhase>;
  using placement = typename compact::placement;

  /// Entries that a lane looks at together. With room for those of spheres that move, and for where these are on their
  /// ways, 48 KB of scratch memory must suffice; and less leaves more of it to the cache.
  static constexpr int ahead = still ? 3 : 2;

  tester<S, NarrowPhase, Sink> const& tests;
  bucket_lookup<S> const& near;
  cell_marks<S> const& marks;

  /// A sphere and its first entry.
  struct alignas(8) numbered {
    id sphere;
    std::uint32_t first;
  };

  /// How many lists of candidates there are, or would be with room for more, and how many spheres have more.
  struct listing {
    std::uint32_t lists, unfinished;
  };

  /// The most entries of a sphere at a time: the block numbers the candidates of all its spheres in 32 bits.
  template <class Block>
  static constexpr std::uint32_t longest = (1u << 30) / Block::lanes;

  template <class Block>
  struct scratch {
    numbered numbers[Block::lanes];                           ///< spheres with candidates
    std::uint32_t counts[Block::lanes];                       ///< how many they have
    std::uint32_t at[Block::lanes];                           ///< where in their cells they are
    typename way<S>::place places[still ? 1 : Block::lanes];  ///< and, of those that move, where on their ways
    listing listed;
    typename Block::balance_scratch balance;
    hit_buffer<Block, ahead> hits;
  };

  /// Tests the spheres that are listed; `one_level` says that this is all that the grids have.
  template <class Block>
  COLLIDE_HD_INLINE void look_up(Block& block, scratch<Block>& s, typename compact::template scratch<Block> const& from,
                                 placement const& found, bool one_level) const {
    int const usable = near.grid_count;
    // the spheres of one level of one grid after the other, in the end those that no grid serves
    for (int g = 0; g <= usable; ++g) {
      bool const all = g == usable;
      if (all && found.unplaced == 0) break;
      for (int l = 0; l < (all || one_level ? 1 : near.grids[g].levels); ++l) {
        cells const here{all ? nullptr : &near.grids[g], all ? nullptr : &near.grids[g].level[l]};
        for (std::uint32_t base = 0; base < found.placed; base += Block::lanes) {
          typename Block::template per_lane<cursor> at;
          bool more = false;
          do {  // once, unless a list is very long, or spheres that move have more lists than there are lanes
            block.each([&](int lane) {
              if (!more) at[lane] = {0, 0};
              std::uint32_t const i = base + static_cast<std::uint32_t>(lane);
              if (i >= found.placed || from.grid_of[i] != (all ? bucket_lookup<S>::everywhere : g)) return;
              bool const all_listed = still && one_level ? list_marked_cell(block, s, from.placed[i], at[lane])
                                                         : list_all(block, s, here, from.placed[i], at[lane]);
              if (!all_listed) block.add(s.listed.unfinished, 1);
            });
            listing const listed = block.shared(s.listed);
            more = listed.unfinished != 0;
            if (listed.lists == 0) continue;
            test_listed(block, s, here, smaller<std::uint32_t>(listed.lists, Block::lanes));
            block.each([&](int lane) {
              if (lane == 0) s.listed = {0, 0};
            });
          } while (more);
        }
      }
    }
  }

 private:
  /// The cells of a level of a grid; without a grid, one cell that lists all triangles.
  struct cells {
    grid<S> const* of;
    grid_level<S> const* level;
  };

  /// How far a sphere has come: steps of its way, and entries of its cell.
  struct cursor {
    std::uint32_t step, skip;
  };

  /// Makes the candidates of the `n` lists: their entries, spread evenly over the lanes.
  template <class Block>
  COLLIDE_HD_INLINE void test_listed(Block& block, scratch<Block>& s, cells const& here, std::uint32_t n) const {
    struct candidates {
      numbered of;
      std::uint32_t list;
    };
    bool const all = here.of == nullptr;
    block.template balanced<ahead>(
        s.balance, s.counts, n,
        [&](std::uint32_t i) {
          return candidates{s.numbers[i], i};
        },
        [&](candidates const& c, std::uint32_t k) {
          return all ? cell_entry{c.of.first + k, cell_part::whole} : near.entries[c.of.first + k];
        },
        [&](candidates const& c, cell_entry const& e) { return cell_part::meets(e.part, s.at[c.list]); },
        [&](candidates const& c, cell_entry const& e) {
          if constexpr (!still) {
            if (!all && !counts_in(here, s.places[c.list], e)) return;
          }
          tests.test(block, s.hits, {c.of.sphere, e.triangle});
        },
        [&] { tests.make_room(block, s.hits); });
  }

  /// True if an entry counts in this cell of a way, and not in another.
  COLLIDE_HD_INLINE bool counts_in(cells const& here, typename way<S>::place const& place, cell_entry const& e) const {
    if (place.later != way<S>::place::unknown) return !cell_part::begins_before(e.part, place.later);
    return place.is_only || place.is_first_of(here.of->range_of(*here.level, near.box_at(e.triangle)));
  }

  /// Lists a sphere with the entries of its cells that are not empty, as far as there is room. True if that was all.
  template <class Block>
  COLLIDE_HD_INLINE bool list_all(Block& block, scratch<Block>& s, cells const& here, id number, cursor& at) const {
    auto const ball = tests.spheres[number];
    if (here.of == nullptr) {
      auto const all = static_cast<std::uint32_t>(near.mesh.size());
      return list(block, s, number, {all, all}, cell_part::anywhere, at);
    } else if constexpr (still) {
      covered_cell const cell = here.of->place_of(*here.level, ball.centre);
      return list(block, s, number, near.lists[cell.number], cell.part, at);
    } else {
      way<S> const path(*here.of, *here.level, ball.centre, ball.displacement);
      for (; at.step < path.steps(); ++at.step, at.skip = 0) {
        auto const place = path.at(at.step);
        std::uint32_t const cell =
            here.level->row(place.cell[1], place.cell[2]) + (place.cell[0] & here.level->mask[0]);
        if (!place.is_cell || !near.is_occupied(cell)) continue;
        if (!list(block, s, number, near.lists[cell], place.part, at, &place)) return false;
      }
      return true;
    }
  }

  /// Lists a sphere that was marked: from what is known of its cell, without asking the grid. True if that was all.
  template <class Block>
  COLLIDE_HD_INLINE bool list_marked_cell(Block& block, scratch<Block>& s, id number, cursor& at) const {
    covered_cell const cell = marks.place_of(tests.spheres[number].centre);
    return list(block, s, number, near.lists[cell.number], cell.part, at);
  }

  /// Lists a sphere with the entries of a cell from at.skip on. False if there was no room for all of them.
  template <class Block>
  COLLIDE_HD_INLINE bool list(Block& block, scratch<Block>& s, id number, cell_list cell, std::uint32_t inside,
                              cursor& at, typename way<S>::place const* place = nullptr) const {
    std::uint32_t const left = cell.count - at.skip, listed = smaller(left, longest<Block>);
    if (left == 0) return true;
    std::uint32_t const slot = block.add(s.listed.lists, 1);
    if (slot >= Block::lanes) return false;
    s.numbers[slot] = {number, cell.end - left};
    s.counts[slot] = listed;
    s.at[slot] = inside;
    if constexpr (!still) {
      if (place != nullptr) s.places[slot] = *place;
    }
    at.skip += listed;
    return left == listed;
  }
};

}  // namespace collide::detail
