/// \file
/// The spheres look for triangles in the cells of grids: compact those that may be near one, expand their cells, test.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/bucket/compact_spheres.hpp>
#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/broad/detail/grid/occupancy.hpp>
#include <collide/broad/detail/grid/swept_cells.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>

namespace collide::detail {

/// Spreads the entries of the spheres' cells over the threads, and makes candidates of those that meet.
template <class S, class NarrowPhase, class Output>
struct expand_cells {
  static constexpr bool still = is_discrete<NarrowPhase, S>;
  using compact = compact_spheres<S, NarrowPhase>;

  /// Entries that a thread looks at together. With room for those of spheres that move, and for where these are on
  /// their paths, 48 KB of scratch memory must suffice; and less leaves more of it to the cache.
  static constexpr int items_per_thread = still ? 5 : 2;

  candidate_pipeline<S, NarrowPhase, Output> const& pipeline;
  bucket_ref<S> const& grids;

  /// A sphere, and the first of the entries of a cell of its.
  struct alignas(8) entry_span {
    id sphere;
    std::uint32_t first;
  };

  /// How many spans there are, or would be with room for more, and how many spheres have more.
  struct counts {
    std::uint32_t spans, threads_with_more;
  };

  /// The most entries of a span: the block numbers the candidates of all its spans in 32 bits.
  template <class Block>
  static constexpr std::uint32_t longest = (1u << 30) / Block::num_threads;

  template <class Block>
  struct scratch {
    entry_span spans[Block::num_threads];
    std::uint32_t sizes[Block::num_threads];      ///< of the spans
    std::uint32_t coverages[Block::num_threads];  ///< where in their cells the spheres are
    typename swept_cells<S>::cell_visit
        cell_visits[still ? 1 : Block::num_threads];      ///< where on its path a moving sphere is
    std::int8_t grid_of[still ? 1 : Block::num_threads];  ///< of a moving sphere
    counts found;
    typename Block::balance_storage balance;
    pipeline_storage<Block, items_per_thread> pipeline;
  };

  /// Makes candidates of the active spheres: from one level of their grids after the other, in the end of those that no
  /// grid serves.
  template <class Block>
  COLLIDE_HD_INLINE void expand(Block& block, scratch<Block>& s, typename compact::template scratch<Block> const& from,
                                typename compact::counts const& active) const {
    int levels = 0;
    for (int g = 0; g < grids.grid_count; ++g) levels = max(levels, grids.grids[g].levels);
    for (int l = 0; l < levels; ++l) expand_level(block, s, from, active.active, l);
    if (active.ungridded != 0) expand_level(block, s, from, active.active, all);
  }

 private:
  static constexpr int all = -1;  ///< in place of a level's number: one cell that lists all triangles

  /// The cells of a level of a grid; without a grid, one cell that lists all triangles.
  struct cells {
    grid<S> const* of;
    grid_level<S> const* level;
    std::int8_t number;  ///< of the grid
  };

  /// How far a sphere has come: steps of its path, and entries of its cell.
  struct cursor {
    std::uint32_t step, skip;
  };

  /// A level of a grid, if a sphere of this grid looks into it.
  COLLIDE_HD_INLINE bool find_cells(std::int8_t grid_number, int level, cells& here) const {
    if (level == all || grid_number < 0) {
      here = {nullptr, nullptr, grid_number};
      return level == all && grid_number == bucket_ref<S>::no_grid;
    }
    grid<S> const& g = grids.grids[grid_number];
    here = {&g, &g.level[level], grid_number};
    return level < g.levels;
  }

  /// Makes candidates of those of the `n` active spheres that are in grids, from the cells of one level.
  template <class Block>
  COLLIDE_HD_INLINE void expand_level(Block& block, scratch<Block>& s,
                                      typename compact::template scratch<Block> const& from, std::uint32_t n,
                                      int level) const {
    for (std::uint32_t base = 0; base < n; base += Block::num_threads) {
      typename Block::template thread_private<cursor> at;
      bool more = false;
      do {  // once, unless a span is very long, or spheres that move have more spans than there are threads
        block.for_each_thread([&](int thread_rank) {
          if (!more) at[thread_rank] = {0, 0};
          std::uint32_t const i = base + static_cast<std::uint32_t>(thread_rank);
          cells here;
          if (i >= n || !find_cells(from.grid_of[i], level, here)) return;
          if (!append_spans(block, s, here, from.active[i], at[thread_rank])) block.add(s.found.threads_with_more, 1);
        });
        counts const found = block.broadcast(s.found);
        more = found.threads_with_more != 0;
        if (found.spans == 0) continue;
        test_spans(block, s, level, min<std::uint32_t>(found.spans, Block::num_threads));
        block.for_each_thread([&](int thread_rank) {
          if (thread_rank == 0) s.found = {0, 0};
        });
      } while (more);
    }
  }

  /// Spreads the entries of `n` spans evenly over the threads, and makes candidates of those that meet.
  template <class Block>
  COLLIDE_HD_INLINE void test_spans(Block& block, scratch<Block>& s, int level, std::uint32_t n) const {
    struct numbered_span {
      entry_span of;
      std::uint32_t number;
    };
    bool const is_all = level == all;
    block.template for_each_balanced<items_per_thread>(
        s.balance, s.sizes, n,
        [&](std::uint32_t i) {
          return numbered_span{s.spans[i], i};
        },
        [&](numbered_span const& c, std::uint32_t k) {
          return is_all ? cell_item{c.of.first + k, cell_coverage::full_box} : grids.entries[c.of.first + k];
        },
        [&](numbered_span const& c, cell_item const& e) {
          return cell_coverage::overlaps(e.coverage, s.coverages[c.number]);
        },
        [&](numbered_span const& c, cell_item const& e) {
          if constexpr (!still) {
            if (!is_all && !owns_pair(grids.grids[s.grid_of[c.number]], level, s.cell_visits[c.number], e)) return;
          }
          pipeline.push(block, s.pipeline, {c.of.sphere, e.triangle});
        },
        [&](bool) { pipeline.drain_if_full(block, s.pipeline); });
  }

  /// True if the pair counts in this cell of a path, and not in another that has the entry too.
  COLLIDE_HD_INLINE bool owns_pair(grid<S> const& g, int level, typename swept_cells<S>::cell_visit const& place,
                                   cell_item const& e) const {
    if (place.later != swept_cells<S>::cell_visit::unknown)
      return !cell_coverage::starts_in_earlier_cell(e.coverage, place.later);
    return place.is_single || place.owns_pair(g.range_of(g.level[level], grids.box_at(e.triangle)));
  }

  /// Appends spans for the cells of a sphere that are not empty, as far as there is room. True if that was all.
  template <class Block>
  COLLIDE_HD_INLINE bool append_spans(Block& block, scratch<Block>& s, cells const& here, id number, cursor& at) const {
    if (here.of == nullptr) {
      auto const triangles = static_cast<std::uint32_t>(grids.mesh.size());
      return append(block, s, here, number, {triangles, triangles}, cell_coverage::full_query, at);
    }
    auto const shape = pipeline.spheres[number];
    if constexpr (still) {
      cell_ref const cell = here.of->cell_at(*here.level, shape.centre);
      return append(block, s, here, number, grids.lists[cell.number], cell.coverage, at);
    } else {
      swept_cells<S> const path(*here.of, *here.level, shape.centre, shape.displacement);
      for (; at.step < path.steps(); ++at.step, at.skip = 0) {
        auto const place = path.at(at.step);
        std::uint32_t const cell =
            here.level->row(place.cell[1], place.cell[2]) + (place.cell[0] & here.level->mask[0]);
        if (!place.is_cell || !grids.is_occupied(cell)) continue;
        if (!append(block, s, here, number, grids.lists[cell], place.coverage, at, &place)) return false;
      }
      return true;
    }
  }

  /// Appends a span for the entries of a cell from at.skip on. False if there was no room for all of them.
  template <class Block>
  COLLIDE_HD_INLINE bool append(Block& block, scratch<Block>& s, [[maybe_unused]] cells const& here, id number,
                                item_range cell, std::uint32_t part, cursor& at,
                                typename swept_cells<S>::cell_visit const* place = nullptr) const {
    std::uint32_t const left = cell.count - at.skip, size = min(left, longest<Block>);
    if (left == 0) return true;
    std::uint32_t const slot = block.add(s.found.spans, 1);
    if (slot >= Block::num_threads) return false;
    s.spans[slot] = {number, cell.end - left};
    s.sizes[slot] = size;
    s.coverages[slot] = part;
    if constexpr (!still) {
      s.grid_of[slot] = here.number;
      if (place != nullptr) s.cell_visits[slot] = *place;
    }
    at.skip += size;
    return left == size;
  }
};

/// Kernel functor: each thread locates some spheres; the few that may be near triangles are gathered in scratch memory,
/// so that threads expand the cells of as many of them at a time as there are threads; the entries of these cells are
/// spread evenly over all threads.
template <class S, class NarrowPhase, class Output>
struct bucket_query {
  static constexpr int items = 4;
  /// The number of threads of a block that take neighbouring spheres. Many more would get all spheres of one crowded
  /// place, and fewer would not read whole lines of memory.
  template <class Block>
  static constexpr std::size_t run_length = Block::num_threads % 4 == 0 ? 4 : 1;
  template <class Block>
  static constexpr int min_blocks_per_sm = is_discrete<NarrowPhase, S>&& filtered_predicate<NarrowPhase>::value ? 4 : 3;

  using compact_type = compact_spheres<S, NarrowPhase>;
  using expand_type = expand_cells<S, NarrowPhase, Output>;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  bucket_ref<S> triangles;
  std::size_t blocks;  ///< that share the spheres

  /// Shares `n` spheres among as many blocks as are at work at a time, if there are enough.
  template <class Space>
  void choose_grid_size(Space const& space, std::size_t n) {
    using block = typename Space::template block<bucket_query>;
    constexpr std::size_t per_run = run_length<block> * static_cast<std::size_t>(block::items);
    blocks = min(space.template max_resident_blocks<bucket_query>(), (n + per_run - 1) / per_run);
  }

  template <class Block>
  struct scratch {
    typename compact_type::template scratch<Block> spheres;
    typename expand_type::template scratch<Block> cells;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    occupancy_view<S> const occupancy = triangles.occupancy();
    bool const has_one_level =
        pipeline.spheres.one_radius() && triangles.has_single_cell_lookup(pipeline.spheres.common_radius());
    bucket_ref<S> const grids = triangles.opened();
    compact_type const spheres{pipeline.spheres, grids, occupancy, has_one_level, blocks, run_length<Block>};
    expand_type const cells{pipeline, grids};
    typename Block::template thread_private<std::size_t> next;
    block.for_each_thread([&](int thread_rank) {
      next[thread_rank] = spheres.first_of(block, thread_rank);
      pipeline.reset(s.cells.pipeline, thread_rank);
      if (thread_rank != 0) return;
      s.spheres.found = {0, 0, 0};
      s.cells.found = {0, 0};
    });
    for (bool more = true; more;) {
      block.for_each_thread([&](int thread_rank) {
        spheres.compact(block, s.spheres, next[thread_rank]);
        if (next[thread_rank] < pipeline.spheres.size()) block.add(s.spheres.found.threads_with_more, 1);
      });
      typename compact_type::counts const found = block.broadcast(s.spheres.found);
      more = found.threads_with_more != 0;
      if (found.active != 0) cells.expand(block, s.cells, s.spheres, found);
      block.for_each_thread([&](int thread_rank) {
        if (thread_rank == 0) s.spheres.found = {0, 0, 0};
      });
    }
    pipeline.drain(block, s.cells.pipeline);
  }
};

}  // namespace collide::detail
