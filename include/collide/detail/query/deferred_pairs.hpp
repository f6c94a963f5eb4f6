/// \file
/// A query in two passes, for narrow phases that are in stages: the filter decides most pairs where they are found; the
/// few that it leaves open are deferred, and decided by a kernel of their own. The kernel that goes through the
/// candidates then has no part in the rare stages: neither their registers nor their calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/grid/all_pairs_ref.hpp>
#include <collide/detail/narrow_phase/intersects.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/memory.hpp>

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
    constexpr std::size_t least = 1024, most = std::size_t{1} << 22;
    return least + min(spheres, most) / 64;
  }

  buffer<deferred_pairs::counters> count_;
  buffer<pair> pairs_;
  bool empty_ = false;  ///< at least when all work that was given to the space is done
};

/// Kernel functor of the second pass: resolves the deferred pairs, and ends the query's pass. If not all of them found
/// room, each thread goes through the candidates of a sphere after the other once more, which loses nothing. A filter
/// on the device has the same outcome in every kernel, as no compiler is free to fuse or reorder what it computes
/// there; so it tells which pairs were deferred.
template <class S, class NarrowPhase, class Output, class Ref>
struct resolve_deferred {
  static constexpr int items = 1;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  deferred_pairs deferred;
  Ref triangles;
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
    std::uint32_t unfinished;  ///< how often a thread had more to do; only rises
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    std::uint64_t const total = deferred.count->total;
    // guard: listed
    bool const all_found_room = total <= deferred.capacity;
    std::uint64_t const work = all_found_room ? total : pipeline.spheres.size();
    std::uint64_t const busy = min<std::uint64_t>(blocks, (work + Block::num_threads - 1) / Block::num_threads);
    if (block.index() >= busy) {
      if (work == 0 && block.index() == 0) {
        block.for_each_thread([&](int thread_rank) {
          if (thread_rank == 0) end_pass(pipeline.output);
        });
      }
      return;
    }

    block.for_each_thread([&](int thread_rank) {
      pipeline.reset(s.pipeline, thread_rank);
      if (thread_rank == 0) s.unfinished = 0;
    });
    if (all_found_room) {
      resolve_listed(block, s, work);
    } else {
      look_again(block, s);
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
  template <class Block>
  COLLIDE_HD_INLINE void resolve_listed(Block& block, scratch<Block>& s, std::uint64_t n) const {
    typename Block::template thread_private<pair> own;
    typename Block::template thread_private<bool> hits;
    for (std::uint64_t base = block.index() * Block::num_threads; base < n; base += blocks * Block::num_threads) {
      block.for_each_thread([&](int thread_rank) {
        std::uint64_t const i = base + static_cast<std::uint64_t>(thread_rank);
        hits[thread_rank] = false;
        if (i >= n) return;
        own[thread_rank] = deferred.pairs[i];
        hits[thread_rank] =
            resolve<NarrowPhase>(pipeline.mesh[own[thread_rank].triangle], pipeline.spheres[own[thread_rank].sphere]);
      });
      pipeline.push_hits(block, s.pipeline, own, hits);
    }
  }

  /// The candidates of a sphere, and how far a thread has gone through them.
  struct progress {
    std::size_t of;  ///< which sphere
    candidate_cursor at;
    candidate_range range;
    std::uint32_t k;     ///< how many of the range
    std::uint64_t seen;  ///< how many of all
  };

  /// Resolves all pairs that the filter leaves uncertain. Each thread goes on to its next hit, then all write theirs.
  template <class Block>
  COLLIDE_HD_INLINE void look_again(Block& block, scratch<Block>& s) const {
    auto const ref = triangles.without_overflown_grids();
    typename Block::template thread_private<progress> state;
    typename Block::template thread_private<pair> own;
    typename Block::template thread_private<bool> hits;
    block.for_each_thread([&](int thread_rank) {
      start(ref, state[thread_rank], block.index() * Block::num_threads + static_cast<std::size_t>(thread_rank));
    });
    for (std::uint32_t seen = 0;;) {
      block.for_each_thread([&](int thread_rank) {
        hits[thread_rank] = next_hit(ref, state[thread_rank], blocks * Block::num_threads, own[thread_rank]);
      });
      block.for_each_thread([&](int thread_rank) {  // behind a barrier, as `push_hits` says
        if (hits[thread_rank]) block.add(s.unfinished, 1);
      });
      pipeline.push_hits(block, s.pipeline, own, hits);
      std::uint32_t const unfinished = block.broadcast(s.unfinished);
      if (unfinished == seen) break;
      seen = unfinished;
    }
  }

  template <class R>
  COLLIDE_HD_INLINE void start(R const& ref, progress& p, std::size_t sphere) const {
    p.of = sphere;
    p.range.count = p.k = 0, p.seen = 0;
    if (sphere < pipeline.spheres.size()) p.at = ref.begin(pipeline.spheres[sphere]);
  }

  /// Goes on to the next hit that the first pass has not written, of this sphere or of every `stride`th behind it.
  /// False if there is none.
  template <class R>
  COLLIDE_HD_INLINE bool next_hit(R const& ref, progress& p, std::size_t stride, pair& found) const {
    while (p.of < pipeline.spheres.size()) {
      auto const shape = pipeline.spheres[p.of];
      while (next_candidate(ref, shape, p)) {
        id const number = p.range.at(p.k - 1).triangle;
        triangle<S> const t = pipeline.mesh[number];
        // guard: first-step
        if (filter<NarrowPhase>(t, shape) != verdict::uncertain) continue;
        if (!resolve<NarrowPhase>(t, shape) || !is_first(ref, shape, p, number)) continue;
        found = {static_cast<id>(p.of), number};
        return true;
      }
      start(ref, p, p.of + stride);
    }
    return false;
  }

  /// Goes on by a candidate; false if there is none. It is the one before p.k then.
  template <class R, class Sphere>
  COLLIDE_HD_INLINE bool next_candidate(R const& ref, Sphere const& shape, progress& p) const {
    if (p.k == p.range.count) {
      if (!ref.next(shape, p.at, most_of_range, p.range)) return false;
      p.k = 0;
    }
    ++p.k, ++p.seen;
    return true;
  }

  /// True if a triangle was no candidate of this sphere before: that of one which moves may be listed in several cells.
  template <class R, class Sphere>
  COLLIDE_HD_INLINE bool is_first(R const& ref, Sphere const& shape, progress const& here, id number) const {
    if constexpr (is_discrete<NarrowPhase, S>) return true;
    progress p;
    start(ref, p, here.of);
    while (next_candidate(ref, shape, p) && p.range.at(p.k - 1).triangle != number) {
    }
    return p.seen == here.seen;
  }

  static constexpr std::uint32_t most_of_range = 1u << 30;
};

/// The triangles near a single sphere as an index has them; all of them if it has none.
template <class Index, class S, class = void>
struct candidates_of_index {
  static all_pairs_ref<S> get(Index const&, mesh_view<S> const& mesh) { return {{mesh, nullptr}}; }
};
template <class Index, class S>
struct candidates_of_index<Index, S, std::void_t<decltype(std::declval<Index const&>().triangle_ref())>> {
  static auto get(Index const& index, mesh_view<S> const&) { return index.triangle_ref(); }
};

/// Runs both passes.
template <class NarrowPhase, class Space, class Index, class S, class Output>
void query_two_pass(Space& space, Index& index, mesh_view<S> const& mesh,
                    sphere_view_for<NarrowPhase, S> const& spheres, Output const& output,
                    deferred_pair_buffer& buffer) {
  deferred_pairs const deferred = buffer.acquire(space, spheres.size());
  index.template query<NarrowPhase>(space, spheres, output_with_deferral<Output>{output, deferred});
  auto const triangles = candidates_of_index<Index, S>::get(index, mesh);
  resolve_deferred<S, NarrowPhase, Output, std::decay_t<decltype(triangles)>> kernel{
      {mesh, spheres, output}, deferred, triangles, 0};
  kernel.choose_grid_size(space);
  space.launch(kernel.blocks, kernel);
  buffer.release();
}

}  // namespace collide::detail
