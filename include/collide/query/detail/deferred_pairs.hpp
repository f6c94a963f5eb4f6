/// \file
/// A query in two passes, for narrow phases that are in stages: the filter decides most pairs where they are found; the
/// few that it leaves open are deferred, and decided by a kernel of their own. The kernel that goes through the
/// candidates then has no part in the rare stages: neither their registers nor their calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include <collide/core/detail/detected.hpp>
#include <collide/core/memory.hpp>
#include <collide/narrow/detail/intersects.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

/// The memory of the deferred pairs. The second pass leaves it empty for the next query.
class deferred_pair_buffer {
 public:
  /// No pairs, and room for those of a query of so many spheres: less of its own where an index has some to spare.
  template <class Space>
  deferred_pairs acquire(Space& space, std::size_t spheres, spare_pairs spare) {
    std::size_t const capacity = capacity_for(spheres, spare.begin != nullptr);
    bool const empty = empty_ && count_.data() != nullptr;  // that of a list which was moved is not there
    auto* const count = count_.reserve(space.resource(), 1);
    if (!empty) space.fill(count, 0, sizeof *count);
    empty_ = false;
    auto* const pairs = pairs_.reserve(space.resource(), capacity);
    return {count, pairs, pairs_.capacity(), spare};
  }

  /// Takes the memory for queries of up to so many spheres.
  template <class Space>
  void reserve(Space const& space, std::size_t spheres) {
    if (count_.data() == nullptr) empty_ = false;
    count_.reserve(space.resource(), 1);
    pairs_.reserve(space.resource(), capacity_for(spheres, false));
  }

  /// To be called when both passes have been launched.
  void release() { empty_ = true; }

 private:
  static std::size_t capacity_for(std::size_t spheres, bool is_spared) {
    std::size_t const of_each = std::size_t{1} << (is_spared ? 17 : 22);
    return 1024 + min(spheres, of_each) + (is_spared ? spheres / 64 : 0);
  }

  buffer<deferred_pairs::counters> count_;
  buffer<pair> pairs_;
  bool empty_ = false;  ///< at least when all work that was given to the space is done
};

/// Kernel functor of the second pass: resolves the deferred pairs, and ends the query's pass. If not all of them found
/// room, each thread goes through the candidates of a sphere after the other once more, which loses nothing. A filter
/// on the device has the same outcome in every kernel, as no compiler is free to fuse or reorder what it computes
/// there; so it tells which pairs were deferred.
template <class S, class NarrowPhase, class Output, class Lookup>
struct resolve_deferred {
  static constexpr int items = 1;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  deferred_pairs deferred;
  Lookup lookup;
  std::size_t blocks;

  /// A few blocks, as mostly few pairs are deferred.
  template <class Space>
  void choose_grid_size(Space const& space) {
    constexpr std::size_t threads = Space::template block<resolve_deferred>::num_threads;
    blocks = min(max<std::size_t>(1, space.saturating_blocks() / 8), (deferred.own_capacity + threads - 1) / threads);
  }

  template <class Block>
  using scratch = pipeline_storage<Block>;

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    std::uint64_t const total = deferred.count->total;
    // guard: listed
    bool const all_were_stored = total <= deferred.capacity();
    std::uint64_t const busy = min<std::uint64_t>(blocks, (total + Block::num_threads - 1) / Block::num_threads);
    if (block.index() >= busy) {
      if (total == 0 && block.index() == 0) {
        block.for_each_thread([&](int thread_rank) {
          if (thread_rank == 0) end_pass(pipeline.output);
        });
      }
      return;
    }

    block.for_each_thread([&](int thread_rank) { pipeline.reset(s, thread_rank); });
    if (all_were_stored) {
      resolve_stored(block, s, total);
    } else {
      look_again(block, busy * Block::num_threads);
    }
    pipeline.drain(block, s);
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
  COLLIDE_HD_INLINE void resolve_stored(Block& block, scratch<Block>& s, std::uint64_t n) const {
    typename Block::template thread_private<pair> own;
    typename Block::template thread_private<bool> hits;
    for (std::uint64_t base = block.index() * Block::num_threads; base < n; base += blocks * Block::num_threads) {
      block.for_each_thread([&](int thread_rank) {
        std::uint64_t const i = base + static_cast<std::uint64_t>(thread_rank);
        hits[thread_rank] = false;
        if (i >= n) return;
        own[thread_rank] = deferred[i];
        hits[thread_rank] =
            resolve<NarrowPhase>(pipeline.mesh[own[thread_rank].triangle], pipeline.spheres[own[thread_rank].sphere]);
      });
      pipeline.push_hits(block, s, own, hits);
    }
  }

  /// How far a thread has gone through the candidates of a sphere.
  struct progress {
    std::size_t number;  ///< of the sphere
    typename Lookup::cursor_type at;
    typename Lookup::range_type range;
    std::uint32_t k;     ///< how many of the range
    std::uint64_t seen;  ///< how many of all
  };

  /// Resolves all pairs that the filter leaves uncertain, of every `stride`-th sphere. Each thread writes its own hits:
  /// ptxas 13.0, not 13.5, lets threads of a warp that return from a call run on alone past a barrier in this loop.
  template <class Block>
  COLLIDE_HD_INLINE void look_again(Block& block, std::size_t stride) const {
    auto const open = lookup.opened();
    block.for_each_thread([&](int thread_rank) {
      progress at = start(open, block.index() * Block::num_threads + static_cast<std::size_t>(thread_rank));
      for (pair p; find_next(open, at, stride, p);) {
        if (resolve<NarrowPhase>(pipeline.mesh[p.triangle], pipeline.spheres[p.sphere])) pipeline.write_hit(p);
      }
    });
  }

  template <class Open>
  COLLIDE_HD_INLINE progress start(Open const& open, std::size_t sphere) const {
    progress p{};
    p.number = sphere;
    if (sphere < pipeline.spheres.size()) p.at = open.begin(pipeline.spheres[sphere]);
    return p;
  }

  /// Goes on to the next pair that the filter leaves uncertain; false if there is none.
  template <class Open>
  COLLIDE_HD_INLINE bool find_next(Open const& open, progress& p, std::size_t stride, pair& found) const {
    for (; p.number < pipeline.spheres.size(); p = start(open, p.number + stride)) {
      auto const shape = pipeline.spheres[p.number];
      id candidate;
      while (next_candidate(open, shape, p, candidate)) {
        triangle<S> const t = pipeline.mesh[candidate];
        // guard: first-step
        if (filter<NarrowPhase>(t, shape) != verdict::uncertain) continue;
        if (!is_first(open, shape, p, candidate)) continue;
        found = {static_cast<id>(p.number), candidate};
        return true;
      }
    }
    return false;
  }

  template <class Open, class Sphere>
  COLLIDE_HD_INLINE bool next_candidate(Open const& open, Sphere const& shape, progress& p, id& number) const {
    constexpr std::uint32_t all = 1u << 30;
    if (p.k >= p.range.count) {
      if (!open.next(shape, p.at, all, p.range)) return false;
      p.k = 0;
    }
    number = p.range.at(p.k).triangle;
    ++p.k, ++p.seen;
    return true;
  }

  /// True if a triangle was no candidate of this sphere before: one that moves may meet it in several cells.
  template <class Open, class Sphere>
  COLLIDE_HD_INLINE bool is_first(Open const& open, Sphere const& shape, progress const& here, id number) const {
    if constexpr (is_discrete<NarrowPhase, S>) return true;
    progress p = start(open, here.number);
    id other;
    while (next_candidate(open, shape, p, other) && other != number) {
    }
    return p.seen == here.seen;
  }
};

/// All triangles, for the spheres of an index that has no `mesh_lookup()`.
struct every_triangle {
  using cursor_type = bool;  ///< true if they have been gone through
  struct range_type {
    std::uint32_t count;
    COLLIDE_HD_INLINE pair at(std::uint32_t k) const { return {0, k}; }
  };

  std::uint32_t triangles;

  COLLIDE_HD_INLINE every_triangle const& opened() const { return *this; }
  template <class Sphere>
  COLLIDE_HD_INLINE cursor_type begin(Sphere const&) const {
    return false;
  }
  template <class Sphere>
  COLLIDE_HD_INLINE bool next(Sphere const&, cursor_type& c, std::uint32_t, range_type& r) const {
    if (c) return false;
    r.count = triangles;
    return c = true;
  }
};

/// An optional member of an index: memory that is free during a query.
template <class Index>
using index_spare_pairs = decltype(std::declval<Index const&>().spare());

template <class Index>
spare_pairs spare_of([[maybe_unused]] Index const& index) {
  if constexpr (is_valid<index_spare_pairs, Index>) return index.spare();
  return {};
}

template <class Index>
using index_mesh_lookup = decltype(std::declval<Index const&>().mesh_lookup());

template <class Index, class S>
auto lookup_of([[maybe_unused]] Index const& index, [[maybe_unused]] mesh_view<S> const& mesh) {
  if constexpr (is_valid<index_mesh_lookup, Index>) {
    return index.mesh_lookup();
  } else {
    return every_triangle{static_cast<std::uint32_t>(mesh.size())};
  }
}

/// Runs both passes.
template <class NarrowPhase, class Space, class Index, class S, class Output>
void query_two_pass(Space& space, Index& index, mesh_view<S> const& mesh,
                    sphere_view_for<NarrowPhase, S> const& spheres, Output const& output,
                    deferred_pair_buffer& buffer) {
  deferred_pairs const deferred = buffer.acquire(space, spheres.size(), spare_of(index));
  index.template query<NarrowPhase>(space, spheres, output_with_deferral<Output>{output, deferred});
  auto const lookup = lookup_of(index, mesh);
  resolve_deferred<S, NarrowPhase, Output, std::decay_t<decltype(lookup)>> kernel{
      {mesh, spheres, output}, deferred, lookup, 0};
  kernel.choose_grid_size(space);
  space.launch(kernel.blocks, kernel);
  buffer.release();
}

}  // namespace collide::detail
