/// \file
/// From candidates, by way of the narrow phase, to hits in the caller's sink.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include <collide/core/detail/detected.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/geometry/bounding_sphere.hpp>
#include <collide/narrow/detail/intersects.hpp>
#include <collide/query/hit.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

/// True for outputs that want to know when all hits of a pass are stored; see concepts.hpp.
template <class Output>
using end_pass_call = decltype(std::declval<Output const&>().end_pass());

template <class Output>
COLLIDE_HD_INLINE void end_pass([[maybe_unused]] Output const& output) {
  if constexpr (is_valid<end_pass_call, Output>) output.end_pass();
}

/// False if the output has no use for `end_pass` in this pass, though its type has one.
template <class Output>
bool wants_end_pass(Output const&) {
  return is_valid<end_pass_call, Output>;
}

/// Kernel functor of `for_each` over one item.
template <class Output>
struct end_pass_kernel {
  Output output;
  COLLIDE_HD void operator()(std::size_t) const { output.end_pass(); }
};

/// True for outputs of which `store` takes the ids of a hit, a `pair`, alone.
COLLIDE_MEMBER_OR(stores_ids, stores_ids, false)

/// True if one hit of each sphere is enough, as the output says; most outputs want them all.
template <class Output>
auto wants_one_of_each(Output const& output, int) -> decltype(output.wants_one_of_each()) {
  return output.wants_one_of_each();
}
template <class Output>
bool wants_one_of_each(Output const&, long) {
  return false;
}

/// True if more hits of a sphere would change nothing, as the output says.
template <class Output>
auto has_enough_of(Output const& output, id sphere, int) -> decltype(output.has_enough_of(sphere)) {
  return output.has_enough_of(sphere);
}
template <class Output>
bool has_enough_of(Output const&, id, long) {
  return false;
}

/// Memory of an index that a query may write pairs to: from `*begin` to `end`, if there is any.
struct spare_pairs {
  pair* memory;
  std::uint32_t const* begin;  ///< null: there is none
  std::uint64_t end;

  COLLIDE_HD_INLINE std::uint64_t size() const { return begin != nullptr && *begin < end ? end - *begin : 0; }
};

/// Pairs that the narrow phase's filter left open, for a kernel of their own; see deferred_pairs.hpp.
struct deferred_pairs {
  struct counters {
    std::uint64_t total;  ///< counts also pairs that found no room
    std::uint64_t ready;  ///< blocks of the second kernel that are done with it
  };

  counters* count;
  pair* pairs;
  std::uint64_t own_capacity;
  spare_pairs spare;  ///< for those that find no room there

  /// How many pairs there is room for.
  COLLIDE_HD_INLINE std::uint64_t capacity() const { return own_capacity + spare.size(); }

  COLLIDE_HD_INLINE pair& operator[](std::uint64_t slot) const {
    return slot < own_capacity ? pairs[slot] : spare.memory[*spare.begin + (slot - own_capacity)];
  }

  COLLIDE_HD_INLINE void add(pair p) const {
    std::uint64_t const slot = fetch_add(&count->total, std::uint64_t{1});
    // guard: room
    if (slot < capacity()) (*this)[slot] = p;
  }
};

/// The output of a pass, and the pairs that are decided later.
template <class Output>
struct output_with_deferral {
  static constexpr bool stores_ids = detail::stores_ids<Output>;

  Output output;
  deferred_pairs deferred;

  COLLIDE_HD_INLINE std::uint64_t allocate(std::uint64_t n) const { return output.allocate(n); }
  template <class Hit>
  COLLIDE_HD_INLINE void store(std::uint64_t slot, Hit const& hit) const {
    output.store(slot, hit);
  }
};

template <class Output>
inline constexpr bool defers_pairs = false;
template <class Output>
inline constexpr bool defers_pairs<output_with_deferral<Output>> = true;

/// Scratch memory of a block for its candidates and hits. Where threads work together, each step is made for many pairs
/// at once, so that no thread waits for another that has more to do: candidates are gathered, then decided; hits are
/// gathered, then written, so that the sink's atomic counter is touched once per batch. A single thread decides each
/// candidate at once. `ItemsPerThread` is how many candidates a thread pushes before there is room for as many again.
template <class Block, int ItemsPerThread = 1>
struct pipeline_storage {
  static constexpr std::uint32_t items_per_thread = ItemsPerThread, capacity = Block::hit_capacity;
  static constexpr bool is_cooperative = Block::num_threads > 1;
  static constexpr std::uint32_t candidate_capacity = is_cooperative ? (ItemsPerThread + 1) * Block::num_threads : 1;

  pair candidates[candidate_capacity];
  std::uint32_t candidate_count;
  pair hits[capacity > 0 ? capacity : 1];
  std::uint32_t hit_count;
  std::uint64_t slot;  ///< the sink's, of the first hit
};

/// Decides candidates with the narrow phase, and writes the hits to `output`: that of a sink, or that of a pass which
/// lists the pairs that the narrow phase's filter leaves open.
template <class S, class NarrowPhase, class Output>
struct candidate_pipeline {
  using narrow_phase = NarrowPhase;

  mesh_view<S> mesh;
  sphere_view_for<NarrowPhase, S> spheres;
  Output output;
  triangle_aabb<S> const* boxes = nullptr;  ///< of candidates that may be out of reach; null if there are no such

  /// To be called first, by every thread; what follows may be done when the block has waited.
  template <class Storage>
  COLLIDE_HD_INLINE void reset(Storage& b, int thread_rank) const {
    if (thread_rank == 0) b.candidate_count = b.hit_count = 0;
  }

  /// Takes a candidate. Called by any thread; where threads work together, at most `items_per_thread` times between two
  /// calls of `drain_if_full`.
  template <class Block, class Storage, class Sphere>
  COLLIDE_HD_INLINE void push(Block& block, Storage& b, pair p, Sphere const& s) const {
    if constexpr (Storage::is_cooperative) {
      push(block, b, p);
    } else {
      process_one(block, b, p, s);
    }
  }

  /// Takes a candidate whose sphere is not at hand.
  template <class Block, class Storage>
  COLLIDE_HD_INLINE void push(Block& block, Storage& b, pair p) const {
    if constexpr (Storage::is_cooperative) {
      b.candidates[block.add(b.candidate_count, 1)] = p;
    } else {
      process_one(block, b, p, spheres[p.sphere]);
    }
  }

  /// Makes room for `items_per_thread` more candidates per thread. Called by the whole block.
  template <class Block, class Storage>
  COLLIDE_HD_INLINE void drain_if_full(Block& block, Storage& b) const {
    if constexpr (Storage::is_cooperative) {
      std::uint32_t const n = block.broadcast(b.candidate_count);
      if (n + Storage::items_per_thread * Block::num_threads > Storage::candidate_capacity) process(block, b, n);
    } else {
      if (b.hit_count == Storage::capacity) write_hits(block, b, b.hit_count);
    }
  }

  /// Decides and writes everything. Called by the whole block, last.
  template <class Block, class Storage>
  COLLIDE_HD_INLINE void drain(Block& block, Storage& b) const {
    if constexpr (Storage::is_cooperative) {
      std::uint32_t const n = block.broadcast(b.candidate_count);
      if (n != 0) process(block, b, n);
    }
    write_hits(block, b, block.broadcast(b.hit_count));
  }

  /// Takes a hit of a thread; see `push_hits`.
  template <class Block, class Storage>
  COLLIDE_HD_INLINE void push_hit(Block& block, Storage& b, pair p) const {
    if constexpr (Storage::is_cooperative) {
      b.hits[block.add(b.hit_count, 1)] = p;
    } else if (b.hit_count != Storage::capacity) {
      b.hits[b.hit_count++] = p;
    } else {
      write_hit(p);
    }
  }

  COLLIDE_HD_INLINE void write_hit(pair p) const { write(output.allocate(1), p); }

  /// Takes the pairs of those threads that have a hit. Called by the whole block. What decides a pair may call a
  /// function, from which the threads of a warp come back one after another; ptxas 13.0 lets some of them run on past a
  /// barrier that follows if there is an atomic operation in between. So they meet at a barrier before they push.
  template <class Block, class Storage, class Pairs, class Flags>
  COLLIDE_HD_INLINE void push_hits(Block& block, Storage& b, Pairs& pairs, Flags& are_hits) const {
    block.for_each_thread([&](int thread_rank) {
      if (are_hits[thread_rank]) push_hit(block, b, pairs[thread_rank]);
    });
    std::uint32_t const hits = block.broadcast(b.hit_count);
    if (hits + Block::num_threads > Storage::capacity) write_hits(block, b, hits);
  }

 private:
  template <class Block, class Storage, class Sphere>
  COLLIDE_HD_INLINE void process_one(Block& block, Storage& b, pair p, Sphere const& s) const {
    if (decide<Block>(p, s)) push_hit(block, b, p);
  }

  /// True if a candidate is a hit. Where threads work together, a narrow phase in stages asks whether the box is in
  /// reach itself.
  template <class Block, class Sphere>
  COLLIDE_HD_INLINE bool decide(pair p, Sphere const& s) const {
    if constexpr (Block::num_threads == 1 || !filtered_predicate<NarrowPhase>::value) {
      sphere<S> const around = swept_bounding_sphere(s);
      if (boxes != nullptr && !boxes[p.triangle].overlaps(around.centre, around.radius)) return false;
    }
    return is_hit(p, mesh[p.triangle], s);
  }

  /// True if the pair is a hit. A pair that the narrow phase's filter leaves uncertain is deferred, or decided at once.
  template <class Sphere>
  COLLIDE_HD_INLINE bool is_hit([[maybe_unused]] pair p, triangle<S> const& t, Sphere const& s) const {
    if constexpr (defers_pairs<Output>) {
      verdict const quick = filter<NarrowPhase>(t, s);
      if (quick == verdict::uncertain) output.deferred.add(p);
      return quick == verdict::hit;
    } else {
      return NarrowPhase::intersects(t, s);
    }
  }

  template <class Block, class Storage>
  COLLIDE_HD_INLINE void process(Block& block, Storage& b, std::uint32_t n) const {
    typename Block::template thread_private<pair> own;
    typename Block::template thread_private<bool> hits;
    for (std::uint32_t base = 0; base < n; base += Block::num_threads) {
      block.for_each_thread([&](int thread_rank) {
        std::uint32_t const i = base + static_cast<std::uint32_t>(thread_rank);
        if (thread_rank == 0) b.candidate_count = 0;
        hits[thread_rank] = false;
        if (i >= n) return;
        own[thread_rank] = b.candidates[i];
        hits[thread_rank] = decide<Block>(own[thread_rank], spheres[own[thread_rank].sphere]);
      });
      push_hits(block, b, own, hits);
    }
  }

  template <class Block, class Storage>
  COLLIDE_HD_INLINE void write_hits(Block& block, Storage& b, std::uint32_t n) const {
    if constexpr (Storage::capacity > 0) {
      if (n == 0) return;
      block.for_each_thread([&](int thread_rank) {
        if (thread_rank != 0) return;
        b.slot = output.allocate(n);
        b.hit_count = 0;
      });
      block.for_each_thread([&](int thread_rank) {
        for (std::uint32_t i = static_cast<std::uint32_t>(thread_rank); i < n; i += Block::num_threads)
          write(b.slot + i, b.hits[i]);
      });
    }
  }

  COLLIDE_HD_INLINE void write(std::uint64_t slot, pair p) const {
    if constexpr (stores_ids<Output>) {
      output.store(slot, p);
    } else {
      output.store(slot, hit<NarrowPhase, S>(p, mesh, spheres));
    }
  }
};

}  // namespace collide::detail
