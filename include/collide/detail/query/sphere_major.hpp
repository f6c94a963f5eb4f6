/// \file
/// The spheres look for triangles in the cells of grids: compact those that may be near one, expand their cells, test.
#pragma once

#include <cstddef>

#include <collide/detail/grid/grid_ref.hpp>
#include <collide/detail/grid/occupancy.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/detail/query/compact_spheres.hpp>
#include <collide/detail/query/expand_cells.hpp>

namespace collide::detail {

/// Kernel body: each lane locates some spheres; the few that may be near triangles are gathered in scratch memory, so
/// that lanes expand the cells of as many of them at a time as there are lanes; the entries of these cells are spread
/// evenly over all lanes.
template <class S, class NarrowPhase, class Output>
struct bucket_query {
  static constexpr int items = 4;
  template <class Block>
  static constexpr int residency = at_rest<NarrowPhase, S> ? 4 : 3;

  using compact_type = compact_spheres<S, NarrowPhase>;
  using expand_type = expand_cells<S, NarrowPhase, Output>;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  bucket_lookup<S> triangles;
  std::size_t blocks;  ///< that share the spheres

  template <class Block>
  struct scratch {
    typename compact_type::template scratch<Block> spheres;
    typename expand_type::template scratch<Block> cells;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    cell_marks<S> const marks = triangles.marks();
    bool const has_one_level = pipeline.spheres.one_radius() && triangles.is_simple(pipeline.spheres.common_radius());
    bucket_lookup<S> const grids = triangles.opened();
    compact_type const spheres{pipeline.spheres, grids, marks, has_one_level, blocks};
    expand_type const cells{pipeline, grids};
    typename Block::template per_lane<std::size_t> next;
    block.each([&](int lane) {
      next[lane] = spheres.first_of(block, lane);
      pipeline.reset(s.cells.hits, lane);
      if (lane != 0) return;
      s.spheres.found = {0, 0, 0};
      s.cells.found = {0, 0};
    });
    for (bool more = true; more;) {
      block.each([&](int lane) {
        spheres.compact(block, s.spheres, next[lane]);
        if (next[lane] < pipeline.spheres.size()) block.add(s.spheres.found.pending, 1);
      });
      typename compact_type::counts const found = block.shared(s.spheres.found);
      more = found.pending != 0;
      if (found.active != 0) cells.expand(block, s.cells, s.spheres, found);
      block.each([&](int lane) {
        if (lane == 0) s.spheres.found = {0, 0, 0};
      });
    }
    pipeline.drain(block, s.cells.hits);
  }
};

}  // namespace collide::detail
