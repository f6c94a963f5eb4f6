/// \file
/// Broad phase: every sphere against every triangle, in tiles. Includes the detector and everything to use it with:
/// with nvcc the CUDA spaces too.
///
/// In the terms of the original study: all_pairs x host = `brute_force_seq`, all_pairs x cuda = `brute_force`, and
/// all_pairs x cuda_shared = `brute_force_shamem`.
#pragma once

#include <collide/broad/detail/mesh_lookup.hpp>
#include <collide/detector.hpp>
#include <collide/exact/detail/geometry/lifted_bounds.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/spaces/detail/block.hpp>
#include <collide/spaces/detail/multiversion.hpp>
#if defined(COLLIDE_COMPILED)
#include <collide/detectors/compiled.hpp>
#endif

namespace collide {

namespace detail {

/// Kernel functor: each thread keeps some spheres; tiles of bounding spheres of the triangles pass by, in shared memory
/// where there is some. Where one is reached by some sphere of a thread, the two are listed, and looked at closely by
/// all threads together. With few spheres the mesh is split among `splits` blocks.
template <class S, class NarrowPhase, class Output>
struct all_pairs_query {
  static constexpr int items = 8;
  template <class Block>
  static constexpr int min_blocks_per_sm = 3;
  static constexpr int tile = 512;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  lifted_bounds<S> const* bounds;
  std::size_t splits;

  /// The spheres of a thread, and a triangle of the tile that some of them may touch.
  struct encounter {
    std::uint16_t thread_rank, triangle;
  };

  template <class Block>
  struct scratch {
    static constexpr std::uint32_t capacity = Block::num_threads > 1 ? 2 * Block::num_threads : 32;
    typename Block::template staging<lifted_bounds<S>, tile> staged;
    encounter encounters[capacity];
    std::uint32_t count;  ///< may be more than there is room for
    pipeline_storage<Block> pipeline;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    constexpr int n = Block::items;
    std::size_t const first = block.index() / splits * Block::num_threads * n;
    std::size_t const triangles = pipeline.mesh.size();
    std::size_t const share = (triangles + splits - 1) / splits;
    std::size_t const begin = block.index() % splits * share;
    std::size_t const end = min(begin + share, triangles);

    typename Block::template thread_private<lifted_batch<S, n>> own;
    vec3<S> const origin = lifted_origin(pipeline.mesh);
    block.for_each_thread([&](int thread_rank) {
      pipeline.reset(s.pipeline, thread_rank);
      if (thread_rank == 0) s.count = 0;
      own[thread_rank].load(pipeline.spheres, first + static_cast<std::size_t>(thread_rank) * n, origin);
    });
    for (std::size_t base = begin; base < end; base += tile) {
      int const m = static_cast<int>(min(static_cast<std::size_t>(tile), end - base));
      auto const* const staged = block.stage(s.staged, bounds + base, m);
      typename Block::template thread_private<int> next;
      bool more = false;
      do {  // again if there were more encounters than go on the list
        block.for_each_thread([&](int thread_rank) {
          if (!more) next[thread_rank] = 0;
          multiversioned(
              [&] { next[thread_rank] = find(block, s, own[thread_rank], staged, next[thread_rank], m, thread_rank); });
        });
        std::uint32_t const found = block.broadcast(s.count);
        more = found > scratch<Block>::capacity;
        test(block, s, min(found, scratch<Block>::capacity), first, base);
      } while (more);
    }
    pipeline.drain(block, s.pipeline);
  }

 private:
  /// Lists the triangles of a tile, from `t` on, that spheres of a thread may touch, as long as there is room; returns
  /// the first for which there was none.
  template <class Block, int N>
  COLLIDE_HD_INLINE static int find(Block& block, scratch<Block>& s, lifted_batch<S, N> const& own,
                                    lifted_bounds<S> const* staged, int t, int m, int thread_rank) {
    for (; t < m; ++t) {
      if (!own.any_overlaps(staged[t])) continue;
      std::uint32_t const slot = block.add(s.count, 1);
      if (slot >= scratch<Block>::capacity) break;
      s.encounters[slot] = {static_cast<std::uint16_t>(thread_rank), static_cast<std::uint16_t>(t)};
    }
    return t;
  }

  /// Makes candidates of the spheres and triangles of `n` encounters that reach each other.
  template <class Block>
  COLLIDE_HD_INLINE void test(Block& block, scratch<Block>& s, std::uint32_t n, std::size_t first,
                              std::size_t base) const {
    if constexpr (Block::num_threads == 1) {
      test_alone(block, s, n, first, base);
    } else {
      test_together(block, s, n, first, base);
    }
  }

  /// In a single thread: the bounding sphere of a triangle once for all of its spheres.
  template <class Block>
  COLLIDE_HD_INLINE void test_alone(Block& block, scratch<Block>& s, std::uint32_t n, std::size_t first,
                                    std::size_t base) const {
    s.count = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
      std::size_t const triangle = base + s.encounters[k].triangle;
      auto const around = bounding_sphere_of(pipeline.mesh[triangle]);
      for (std::uint32_t j = 0; j < std::uint32_t{Block::items}; ++j) {
        test_one(block, s, first + j, triangle, [&] { return around; });
        pipeline.drain_if_full(block, s.pipeline);
      }
    }
  }

  template <class Block>
  COLLIDE_HD_INLINE void test_together(Block& block, scratch<Block>& s, std::uint32_t n, std::size_t first,
                                       std::size_t base) const {
    constexpr std::uint32_t per_thread = Block::items;
    for (std::uint32_t i = 0; i < n * per_thread; i += Block::num_threads) {
      block.for_each_thread([&](int thread_rank) {
        if (thread_rank == 0) s.count = 0;
        std::uint32_t const own = i + static_cast<std::uint32_t>(thread_rank);
        if (own >= n * per_thread) return;
        encounter const e = s.encounters[own / per_thread];
        std::size_t const triangle = base + e.triangle;
        test_one(block, s, first + std::size_t{e.thread_rank} * per_thread + own % per_thread, triangle,
                 [&] { return bounding_sphere_of(pipeline.mesh[triangle]); });
      });
      pipeline.drain_if_full(block, s.pipeline);
    }
  }

  template <class Block, class BoundingSphere>
  COLLIDE_HD_INLINE void test_one(Block& block, scratch<Block>& s, std::size_t i, std::size_t triangle,
                                  BoundingSphere const& of_triangle) const {
    if (i >= pipeline.spheres.size()) return;
    auto const shape = pipeline.spheres[i];
    sphere<S> const around = swept_bounding_sphere(shape);
    if (!of_triangle().overlaps(around.centre, around.radius)) return;
    pipeline.push(block, s.pipeline, {static_cast<id>(i), static_cast<id>(triangle)}, shape);
  }
};

/// Kernel functor of `for_each` over triangles.
template <class S>
struct compute_lifted_bounds {
  mesh_view<S> mesh;
  lifted_bounds<S>* bounds;
  COLLIDE_HD void operator()(std::size_t i) const {
    // ptxas 13.0 reads the origin from a wrong place if it is read before the sphere is computed
    bounds[i] = lifted_bounds<S>(bounding_sphere_of(mesh[i]), lifted_origin(mesh));
  }
};

}  // namespace detail

/// Broad phase: all pairs. Nothing but a bounding sphere per triangle is prepared, so it is the right choice for small
/// meshes. Build O(triangles), query O(spheres * triangles); memory 8 scalars per triangle.
struct all_pairs {
  template <class S>
  class index {
   public:
    template <class Space>
    void build(Space& space, all_pairs const&, mesh_view<S> mesh) {
      mesh_ = mesh;
      bounds_.reserve(space.resource(), mesh.size());
      space.for_each(mesh.size(), detail::compute_lifted_bounds<S>{mesh, bounds_.data()});
    }

    template <class Space>
    void prepare(Space&, all_pairs const&, S) {}

    template <class Space>
    void prepare(Space&, all_pairs const&, sphere_view<S> const&) {}

    template <class NarrowPhase, class Space, class Output>
    void query(Space& space, detail::sphere_view_for<NarrowPhase, S> const& spheres, Output const& output) const {
      detail::all_pairs_query<S, NarrowPhase, Output> kernel{{mesh_, spheres, output}, bounds_.data(), 1};
      std::size_t const blocks = detail::grid_size<Space>(spheres.size(), kernel);
      std::size_t const tiles = (mesh_.size() + kernel.tile - 1) / kernel.tile;
      std::size_t const wanted = (space.saturating_blocks() + blocks - 1) / blocks;
      kernel.splits = detail::max<std::size_t>(1, detail::min(wanted, tiles));
      space.launch(blocks * kernel.splits, kernel);
    }

    /// The triangles near a single sphere, for a kernel; valid until the next build.
    detail::all_pairs_ref<S> mesh_lookup() const { return {{mesh_, nullptr}}; }

    /// A reference for kernels to the triangles near a point; valid until the next build.
    detail::all_pairs_ref<S> ref() const { return mesh_lookup(); }

    template <class Space>
    double cell_width(Space&) const {
      return 0;
    }

   private:
    mesh_view<S> mesh_;
    buffer<detail::lifted_bounds<S>> bounds_;
  };
};

#if defined(COLLIDE_COMPILED)
COLLIDE_ELSEWHERE(all_pairs)
#endif

}  // namespace collide
