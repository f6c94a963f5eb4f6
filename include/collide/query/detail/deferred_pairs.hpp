/// \file
/// A query in two passes, for narrow phases that are in stages: the filter decides most pairs where they are found; the
/// few that it leaves open are deferred, and decided by a kernel of their own. The kernel that goes through the
/// candidates then has no part in the rare stages: neither their registers nor their calls.
#pragma once

#include <collide/core/memory.hpp>
#include <collide/exact/detail/geometry/bounding_sphere.hpp>
#include <collide/exact/detail/geometry/swept_bounds.hpp>
#include <collide/narrow/detail/intersects.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

/// The memory of the deferred pairs. The second pass leaves it empty for the next query.
class deferred_pair_buffer {
 public:
  /// No pairs, and room for those of a query of so many spheres.
  template <class Space>
  deferred_pairs acquire(Space& space, std::size_t spheres) {
    std::size_t const capacity = capacity_for(spheres);
    bool const empty = empty_ && count_.data() != nullptr;  // that of a list which was moved is not there
    auto* const count = count_.reserve(space.resource(), 1);
    if (!empty) space.fill(count, 0, sizeof *count);
    empty_ = false;
    return {count, pairs_.reserve(space.resource(), capacity), capacity};
  }

  /// Takes the memory for queries of up to so many spheres.
  template <class Space>
  void reserve(Space const& space, std::size_t spheres) {
    if (count_.data() == nullptr) empty_ = false;
    count_.reserve(space.resource(), 1);
    pairs_.reserve(space.resource(), capacity_for(spheres));
  }

  /// To be called when both passes have been launched.
  void release() { empty_ = true; }

 private:
  static std::size_t capacity_for(std::size_t spheres) {
    constexpr std::size_t min_count = 1024, max_count = std::size_t{1} << 22;
    return min_count + min(spheres, max_count);
  }

  buffer<deferred_pairs::counters> count_;
  buffer<pair> pairs_;
  bool empty_ = false;  ///< at least when all work that was given to the space is done
};

/// Kernel functor of the second pass: resolves the deferred pairs, and ends the query's pass. If not all of them found
/// room, it goes through all pairs of spheres and triangles, plainly: that is slow, but hardly ever happens, and loses
/// nothing. A filter on the device has the same outcome in every kernel, as no compiler is free to fuse or reorder what
/// it computes there; so it tells which pairs were deferred.
template <class S, class NarrowPhase, class Output>
struct resolve_deferred {
  static constexpr int items = 1;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  deferred_pairs deferred;
  std::size_t blocks;

  /// A few blocks, as few pairs are deferred.
  template <class Space>
  void choose_grid_size(Space const& space) {
    constexpr std::size_t threads = Space::template block<resolve_deferred>::num_threads;
    blocks = min(max<std::size_t>(1, space.saturating_blocks() / 8), (deferred.capacity + threads - 1) / threads);
  }

  template <class Block>
  struct scratch {
    pipeline_storage<Block> pipeline;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    std::uint64_t const total = deferred.count->total;
    // guard: listed
    bool const all_were_stored = total <= deferred.capacity;
    // guard: second-time
    std::uint64_t const work = all_were_stored ? total : std::uint64_t{pipeline.spheres.size()} * pipeline.mesh.size();
    std::uint64_t const busy = min<std::uint64_t>(blocks, (work + Block::num_threads - 1) / Block::num_threads);
    if (block.index() >= busy) {
      if (work == 0 && block.index() == 0) {
        block.for_each_thread([&](int thread_rank) {
          if (thread_rank == 0) end_pass(pipeline.output);
        });
      }
      return;
    }

    block.for_each_thread([&](int thread_rank) { pipeline.reset(s.pipeline, thread_rank); });
    typename Block::template thread_private<pair> own;
    typename Block::template thread_private<bool> hits;
    for (std::uint64_t base = block.index() * Block::num_threads; base < work; base += blocks * Block::num_threads) {
      block.for_each_thread([&](int thread_rank) {
        std::uint64_t const i = base + static_cast<std::uint64_t>(thread_rank);
        hits[thread_rank] = false;
        if (i >= work) return;
        own[thread_rank] = all_were_stored ? deferred.pairs[i]
                                           : pair{static_cast<id>(i / pipeline.mesh.size()),
                                                  static_cast<id>(i % pipeline.mesh.size())};
        hits[thread_rank] = is_hit(own[thread_rank], all_were_stored);
      });
      pipeline.push_hits(block, s.pipeline, own, hits);
    }
    pipeline.drain(block, s.pipeline);
    // the last block that had something to do empties the list; those that come later find it so
    block.for_each_thread([&](int thread_rank) {
      if (thread_rank != 0 || fetch_add(&deferred.count->ready, std::uint64_t{1}) + 1 != busy) return;
      // guard: left-empty
      deferred.count->total = deferred.count->ready = 0;
      end_pass(pipeline.output);
    });
  }

 private:
  /// True if a pair is a hit that the first pass has not written.
  COLLIDE_HD_INLINE bool is_hit(pair p, bool is_deferred) const {
    triangle<S> const t = pipeline.mesh[p.triangle];
    auto const shape = pipeline.spheres[p.sphere];
    if (!is_deferred) {
      sphere<S> const around = swept_bounding_sphere(shape);
      if (!bounding_sphere_of(t).overlaps(around.centre, around.radius)) return false;
      // guard: first-step
      if (filter<NarrowPhase>(t, shape) != verdict::uncertain) return false;
    }
    return resolve<NarrowPhase>(t, shape);
  }
};

/// Runs both passes.
template <class NarrowPhase, class Space, class Index, class S, class Output>
void query_two_pass(Space& space, Index& index, mesh_view<S> const& mesh,
                    sphere_view_for<NarrowPhase, S> const& spheres, Output const& output,
                    deferred_pair_buffer& buffer) {
  deferred_pairs const deferred = buffer.acquire(space, spheres.size());
  index.template query<NarrowPhase>(space, spheres, output_with_deferral<Output>{output, deferred});
  resolve_deferred<S, NarrowPhase, Output> kernel{{mesh, spheres, output}, deferred, 0};
  kernel.choose_grid_size(space);
  space.launch(kernel.blocks, kernel);
  buffer.release();
}

}  // namespace collide::detail
