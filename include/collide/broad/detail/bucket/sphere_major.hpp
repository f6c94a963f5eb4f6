/// \file
/// The spheres look for triangles in the cells of grids: compact those that may be near one, expand their cells, test.
#pragma once

#include <cstddef>

#include <collide/broad/detail/bucket/compact_spheres.hpp>
#include <collide/broad/detail/bucket/expand_cells.hpp>
#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/broad/detail/grid/occupancy.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>

namespace collide::detail {

/// Kernel functor: each thread locates some spheres; the few that may be near triangles are gathered in scratch memory,
/// so that threads expand the cells of as many of them at a time as there are threads; the entries of these cells are
/// spread evenly over all threads.
template <class S, class NarrowPhase, class Output>
struct bucket_query {
  static constexpr int items = 4;
  /// So many threads of a block take spheres next to each other, where it has them: many more would get all of what is
  /// crowded in one place, and fewer would not read whole lines of memory.
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
