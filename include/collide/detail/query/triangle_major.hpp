/// \file
/// The triangles look for spheres that are sorted into cells; sorted_spheres.hpp explains why.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/detail/execution/multiversion.hpp>
#include <collide/detail/grid/triangle_cells.hpp>
#include <collide/detail/query/bin_spheres.hpp>
#include <collide/detail/query/candidate_batch.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>

namespace collide::detail {

/// Kernel body of a block of one thread: triangles look for spheres in the cells that they touch.
template <class S, class NarrowPhase, class Output>
struct query_triangle_major {
  static constexpr int items = 4;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  triangle_aabb<S> const* boxes;
  grid<S> const* grids;
  int grid_count;
  sphere_soa<S> spheres;
  std::uint32_t const* ends;  ///< the spheres of cell c: ends[c] .. ends[c + 1]
  std::uint32_t everywhere;   ///< number of the cell behind the last

  /// Spheres `first` + k whose bit k is set, and a triangle whose box they reach.
  struct reached {
    std::uint32_t first, mask;
    id triangle;
  };

  template <class Block>
  struct scratch {
    static constexpr std::uint32_t room = 256;
    reached found[room];
    std::uint32_t count;
    candidate_batch<S> batch;
    pipeline_storage<Block> hits;
  };

  template <class Block>
  void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::num_threads == 1, "collide: triangles look for spheres in blocks of one lane");
    pipeline.reset(s.hits, 0);
    s.count = 0;
    s.batch.size = 0;
    multiversioned([&] { look(block, s); });
    test(block, s);
    if constexpr (in_batches<NarrowPhase, S>) s.batch.decide(pipeline, block, s.hits);
    pipeline.drain(block, s.hits);
  }

 private:
  /// Finds the spheres near the triangles of a block.
  template <class Block>
  void look(Block& block, scratch<Block>& s) const {
    std::size_t const begin = block.index() * Block::items, end = smaller(begin + Block::items, pipeline.mesh.size());
    for (std::size_t t = begin; t < end; ++t) {
      triangle_aabb<S> const around = boxes[t];
      if (around.is_empty()) continue;  // not finite
      auto const look_into = [&](std::uint32_t cell, std::uint32_t n) {
        std::uint32_t const last = ends[cell + n];
        for (std::uint32_t i = ends[cell]; i < last; i += spheres.simd_width) {
          std::uint32_t const here = spheres.reaching(around, i) & (0xffu >> (8 - smaller(last - i, 8u)));
          s.found[s.count] = {i, here, static_cast<id>(t)};
          s.count += here != 0;  // no branch: it would often be mispredicted
          if (s.count == s.room) test(block, s);
        }
      };
      for (int g = 0; g < grid_count; ++g) {
        each_range(
            grids[g], around, [&] { return pipeline.mesh[t]; }, look_into);
      }
      look_into(everywhere, 1);
    }
  }

  /// Tests what was found. Out of line: `look` is a tight loop that is compiled for two vector units.
  template <class Block>
  [[gnu::noinline]] void test(Block& block, scratch<Block>& s) const {
    for (std::uint32_t i = 0; i < s.count; ++i) {
      reached const r = s.found[i];
      [[maybe_unused]] triangle<S> const t = pipeline.mesh[r.triangle];
      for (std::uint32_t rest = r.mask; rest != 0; rest &= rest - 1) {
        std::uint32_t const place = r.first + static_cast<std::uint32_t>(__builtin_ctz(rest));
        pair const p{spheres.number[place], r.triangle};
        if constexpr (in_batches<NarrowPhase, S>) {
          if (s.batch.size == s.batch.room) s.batch.decide(pipeline, block, s.hits);
          s.batch.add(p, t, sphere_of(place));
        } else {
          pipeline.push(block, s.hits, p, sphere_of(place));
          pipeline.drain_if_full(block, s.hits);
        }
      }
    }
    s.count = 0;
  }

  /// What the narrow phase judges.
  decltype(auto) sphere_of(std::uint32_t place) const {
    if constexpr (is_discrete<NarrowPhase, S>) {
      return spheres[place];
    } else {
      return static_cast<moving_sphere<S> const&>(spheres.moving[place]);
    }
  }
};

}  // namespace collide::detail
