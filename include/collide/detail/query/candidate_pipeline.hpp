/// \file
/// From candidates, by way of the narrow phase, to hits in the caller's sink.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include <collide/detail/geometry/aabb.hpp>
#include <collide/detail/geometry/swept_bounds.hpp>
#include <collide/detail/narrow_phase/intersects.hpp>
#include <collide/hit.hpp>

namespace collide::detail {

/// True for handles that want to know when all hits of a pass are stored; see concepts.hpp.
template <class Handle, class = void>
struct finishes : std::false_type {};
template <class Handle>
struct finishes<Handle, std::void_t<decltype(std::declval<Handle const&>().finish())>> : std::true_type {};

template <class Handle>
COLLIDE_HD_INLINE void finish_pass([[maybe_unused]] Handle const& handle) {
  if constexpr (finishes<Handle>::value) handle.finish();
}

/// False if the handle has no use for `finish` in this pass, though its type has one.
template <class Handle>
bool wants_finish(Handle const&) {
  return finishes<Handle>::value;
}

/// Kernel body of `for_each` over one item.
template <class Handle>
struct finish_only {
  Handle handle;
  COLLIDE_HD void operator()(std::size_t) const { handle.finish(); }
};

/// What a pass over candidates does with them: decides each, and takes the hits to the handle of the caller's sink. A
/// pass that puts some off is in detail/query/deferred_pairs.hpp.
template <class Handle>
struct deciding {
  Handle handle;

  /// True if the pair is a hit to be reported in this pass.
  template <class NarrowPhase, class S, class Ball>
  COLLIDE_HD_INLINE bool takes(pair, triangle<S> const& t, Ball const& s) const {
    return NarrowPhase::intersects(t, s);
  }

  COLLIDE_HD_INLINE std::uint64_t reserve(std::uint64_t n) const { return handle.reserve(n); }
  template <class Hit>
  COLLIDE_HD_INLINE void store(std::uint64_t slot, Hit const& hit) const {
    handle.store(slot, hit);
  }
};

/// The way of candidates to the sink, in the scratch memory of a block. Where lanes work together, each step is made
/// for many pairs at once, so that no lane waits for another that has more to do: candidates are listed, then decided;
/// hits are listed, then stored, so that the sink's atomic counter is touched once per batch. A single lane decides
/// each candidate at once. `Ahead` is how many candidates a lane lists before there is room for as many again.
template <class Block, int Ahead = 1>
struct hit_buffer {
  static constexpr std::uint32_t capacity = Block::pending;
  static constexpr bool together = Block::lanes > 1;
  static constexpr std::uint32_t candidate_capacity = together ? (Ahead + 1) * Block::lanes : 1;

  pair candidates[candidate_capacity];
  std::uint32_t candidate_count;
  pair hits[capacity > 0 ? capacity : 1];
  std::uint32_t hit_count;
  std::uint64_t slot;  ///< the sink's, of the first hit
};

template <class S, class NarrowPhase, class Sink>
struct tester {
  using narrow_phase = NarrowPhase;

  mesh_view<S> mesh;
  spheres_of<NarrowPhase, S> spheres;
  Sink sink;
  triangle_box<S> const* boxes = nullptr;  ///< of candidates that may be out of reach; null if there are no such

  /// To be called first, by every lane; what follows may be done when the block has waited.
  template <class Block, int Ahead>
  COLLIDE_HD_INLINE void begin(hit_buffer<Block, Ahead>& b, int lane) const {
    if (lane == 0) b.candidate_count = b.hit_count = 0;
  }

  /// Takes a candidate. Called by any lane; where lanes work together, at most `Ahead` times between two calls of
  /// `make_room`.
  template <class Block, int Ahead, class Ball>
  COLLIDE_HD_INLINE void test(Block& block, hit_buffer<Block, Ahead>& b, pair p, Ball const& s) const {
    if constexpr (hit_buffer<Block, Ahead>::together) {
      test(block, b, p);
    } else {
      decide(block, b, p, s);
    }
  }

  /// The same where the sphere is not at hand.
  template <class Block, int Ahead>
  COLLIDE_HD_INLINE void test(Block& block, hit_buffer<Block, Ahead>& b, pair p) const {
    if constexpr (hit_buffer<Block, Ahead>::together) {
      b.candidates[block.add(b.candidate_count, 1)] = p;
    } else {
      decide(block, b, p, spheres[p.sphere]);
    }
  }

  /// Makes room for `Ahead` more candidates per lane. Called by the whole block.
  template <class Block, int Ahead>
  COLLIDE_HD_INLINE void make_room(Block& block, hit_buffer<Block, Ahead>& b) const {
    if constexpr (hit_buffer<Block, Ahead>::together) {
      std::uint32_t const n = block.shared(b.candidate_count);
      if (n + Ahead * Block::lanes > hit_buffer<Block, Ahead>::candidate_capacity) decide_all(block, b, n);
    } else {
      if (b.hit_count == hit_buffer<Block, Ahead>::capacity) store_all(block, b, b.hit_count);
    }
  }

  /// Finishes everything. Called by the whole block, last.
  template <class Block, int Ahead>
  COLLIDE_HD_INLINE void flush(Block& block, hit_buffer<Block, Ahead>& b) const {
    if constexpr (hit_buffer<Block, Ahead>::together) {
      std::uint32_t const n = block.shared(b.candidate_count);
      if (n != 0) decide_all(block, b, n);
    }
    store_all(block, b, block.shared(b.hit_count));
  }

  /// Takes a hit. Called by any lane; where lanes work together, once for each candidate at most.
  template <class Block, int Ahead>
  COLLIDE_HD_INLINE void keep(Block& block, hit_buffer<Block, Ahead>& b, pair p) const {
    if constexpr (hit_buffer<Block, Ahead>::together) {
      b.hits[block.add(b.hit_count, 1)] = p;
    } else if (b.hit_count != hit_buffer<Block, Ahead>::capacity) {
      b.hits[b.hit_count++] = p;
    } else {
      store(sink.reserve(1), p);
    }
  }

 private:
  template <class Block, int Ahead, class Ball>
  COLLIDE_HD_INLINE void decide(Block& block, hit_buffer<Block, Ahead>& b, pair p, Ball const& s) const {
    if constexpr (!(Block::lanes > 1 && in_stages<NarrowPhase>::value)) {  // else its first stage asks the same
      sphere<S> const around = enclosing(s);
      if (boxes != nullptr && !boxes[p.triangle].reached(around.centre, around.radius)) return;
    }
    if (sink.template takes<NarrowPhase>(p, mesh[p.triangle], s)) keep(block, b, p);
  }

  /// Decides the `n` candidates that are listed.
  template <class Block, int Ahead>
  COLLIDE_HD_INLINE void decide_all(Block& block, hit_buffer<Block, Ahead>& b, std::uint32_t n) const {
    for (std::uint32_t base = 0; base < n; base += Block::lanes) {
      block.each([&](int lane) {
        std::uint32_t const i = base + static_cast<std::uint32_t>(lane);
        if (lane == 0) b.candidate_count = 0;
        if (i >= n) return;
        pair const p = b.candidates[i];
        decide(block, b, p, spheres[p.sphere]);
      });
      std::uint32_t const hits = block.shared(b.hit_count);
      if (hits + Block::lanes > hit_buffer<Block, Ahead>::capacity) store_all(block, b, hits);
    }
  }

  /// Stores the `n` hits that are listed.
  template <class Block, int Ahead>
  COLLIDE_HD_INLINE void store_all(Block& block, hit_buffer<Block, Ahead>& b, std::uint32_t n) const {
    if constexpr (hit_buffer<Block, Ahead>::capacity > 0) {
      if (n == 0) return;
      block.each([&](int lane) {
        if (lane != 0) return;
        b.slot = sink.reserve(n);
        b.hit_count = 0;
      });
      block.each([&](int lane) {
        for (std::uint32_t i = static_cast<std::uint32_t>(lane); i < n; i += Block::lanes) store(b.slot + i, b.hits[i]);
      });
    }
  }

  COLLIDE_HD_INLINE void store(std::uint64_t slot, pair p) const {
    sink.store(slot, hit<NarrowPhase, S>(p, mesh, spheres));
  }
};

}  // namespace collide::detail
