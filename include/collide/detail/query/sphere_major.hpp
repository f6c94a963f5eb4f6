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

/// Kernel body: each lane places some spheres; the few that are inside a grid are listed in scratch memory, so that
/// lanes look up the cells of as many of them at a time as there are lanes; those whose cell is not empty are listed
/// again, and their candidates are spread evenly over all lanes.
template <class S, class NarrowPhase, class Sink>
struct bucket_query {
  static constexpr int items = 4;
  template <class Block>
  static constexpr int residency = at_rest<NarrowPhase, S> ? 4 : 3;

  using compact = compact_spheres<S, NarrowPhase>;
  using expand = expand_cells<S, NarrowPhase, Sink>;

  tester<S, NarrowPhase, Sink> tests;
  bucket_lookup<S> triangles;
  std::size_t blocks;  ///< that share the spheres

  template <class Block>
  struct scratch {
    typename compact::template scratch<Block> spheres;
    typename expand::template scratch<Block> cells;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    cell_marks<S> const marks = triangles.marks();
    bool const simple = tests.spheres.one_radius() && triangles.is_simple(tests.spheres.common_radius());
    bucket_lookup<S> const near = triangles.opened();
    compact const spheres{tests.spheres, blocks};
    expand const cells{tests, near, marks};
    typename Block::template per_lane<std::size_t> next;
    typename Block::template per_lane<typename compact::template group<Block>> own;
    S const* const quads = spheres.template quads_of<Block>();
    block.each([&](int lane) {
      next[lane] = spheres.first_of(block, lane);
      if (compact::loads_early) spheres.template load_ahead<Block>(own[lane], quads, next[lane]);
      tests.begin(s.cells.hits, lane);
      if (lane != 0) return;
      s.spheres.found = {0, 0, 0};
      s.cells.listed = {0, 0};
    });
    for (;;) {
      block.each([&](int lane) {
        if (simple) {
          spheres.mark_many(block, s.spheres, marks, near, next[lane], quads, own[lane]);
        } else {
          spheres.template place_many<Block>(
              next[lane], [&](std::size_t first) { return spheres.place_own(block, s.spheres, near, first); });
        }
        if (next[lane] < tests.spheres.size()) block.add(s.spheres.found.unfinished, 1);
      });
      typename compact::placement const found = block.shared(s.spheres.found);
      if (found.placed != 0) cells.look_up(block, s.cells, s.spheres, found, simple);
      if (found.unfinished == 0) break;
      block.each([&](int lane) {
        if (lane == 0) s.spheres.found = {0, 0, 0};
        if (compact::loads_early) spheres.template load_ahead<Block>(own[lane], quads, next[lane]);
      });
    }
    tests.flush(block, s.cells.hits);
  }
};

}  // namespace collide::detail
