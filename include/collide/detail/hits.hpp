/// \file
/// From a hit in a kernel to the caller's sink.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include <collide/contact.hpp>
#include <collide/detail/spheres_of.hpp>
#include <collide/impact.hpp>
#include <collide/mesh.hpp>

namespace collide {

namespace detail {

template <class N, class S, class = void>
struct has_contact : std::false_type {};
template <class N, class S>
struct has_contact<
    N, S,
    std::void_t<decltype(N::contact_of(std::declval<triangle<S> const&>(), std::declval<moving_sphere<S> const&>()))>>
    : std::true_type {};

template <class N, class S, class = void>
struct has_impact : std::false_type {};
template <class N, class S>
struct has_impact<
    N, S,
    std::void_t<decltype(N::impact_of(std::declval<triangle<S> const&>(), std::declval<moving_sphere<S> const&>()))>>
    : std::true_type {};

}  // namespace detail

/// A colliding pair as a sink sees it: its ids, and on demand its geometry.
template <class NarrowPhase, class S>
class hit {
 public:
  id sphere;    ///< number of the sphere
  id triangle;  ///< number of the triangle

  using spheres_type = detail::spheres_of<NarrowPhase, S>;

  COLLIDE_HD hit(pair p, mesh_view<S> const& mesh, spheres_type const& spheres)
      : sphere{p.sphere}, triangle{p.triangle}, mesh_{mesh}, spheres_{spheres} {}

  /// Where and how the two touch; computed here and now.
  COLLIDE_HD collide::contact<S> contact() const {
    static_assert(
        detail::has_contact<NarrowPhase, S>::value,
        "collide: contacts need a narrow phase with a static member contact_of(triangle, sphere) that returns a "
        "contact");
    collide::contact<S> c = NarrowPhase::contact_of(mesh_[triangle], spheres_[sphere]);
    c.sphere = sphere;
    c.triangle = triangle;
    return c;
  }

  /// When the two touch first within the step, and the contact then; computed here and now.
  COLLIDE_HD collide::impact<S> impact() const {
    static_assert(
        detail::has_impact<NarrowPhase, S>::value,
        "collide: impacts need a narrow phase for spheres that move, with a static member impact_of(triangle, "
        "moving_sphere) that returns an impact, such as karabassi_swept");
    collide::impact<S> i = NarrowPhase::impact_of(mesh_[triangle], spheres_[sphere]);
    i.contact.sphere = sphere;
    i.contact.triangle = triangle;
    return i;
  }

 private:
  mesh_view<S> const& mesh_;
  spheres_type const& spheres_;
};

namespace detail {

/// What a pass over candidates does with them: decides each, and takes the hits to the handle of the caller's sink.
/// Passes that put some off are in detail/undecided.hpp.
template <class Handle>
struct deciding {
  Handle handle;

  /// False if the pass has nothing to do.
  COLLIDE_HD_INLINE bool needed() const { return true; }

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

/// The candidates' last stop: runs the narrow phase and hands the hits to the sink, `Block::pending` at a time, so that
/// the sink's atomic counter is touched once per batch and the lanes share the work of storing.
template <class Block>
struct hit_buffer {
  static constexpr std::uint32_t capacity = Block::pending;

  pair hits[capacity > 0 ? capacity : 1];
  std::uint32_t found;
  std::uint64_t slot;
};

template <class S, class NarrowPhase, class Sink>
struct tester {
  using narrow_phase = NarrowPhase;

  mesh_view<S> mesh;
  spheres_of<NarrowPhase, S> spheres;
  Sink sink;

  /// Runs the narrow phase on one candidate. Called by any lane.
  template <class Block, class Ball>
  COLLIDE_HD_INLINE void test(Block& block, hit_buffer<Block>& b, pair p, Ball const& s) const {
    if (sink.template takes<NarrowPhase>(p, mesh[p.triangle], s)) keep(block, b, p);
  }

  /// Takes a hit. Called by any lane.
  template <class Block>
  COLLIDE_HD_INLINE void keep(Block& block, hit_buffer<Block>& b, pair p) const {
    if constexpr (hit_buffer<Block>::capacity > 0) {
      std::uint32_t const place = block.add(b.found, 1);
      if (place < hit_buffer<Block>::capacity) {
        b.hits[place] = p;
        return;
      }
    }
    store(sink.reserve(1), p);
  }

  /// To be called first, by the whole block. False if there is nothing to do.
  template <class Block>
  COLLIDE_HD_INLINE bool begin(Block& block, hit_buffer<Block>& b) const {
    if (!sink.needed()) return false;
    block.each([&](int lane) {
      if (lane == 0) b.found = 0;
    });
    return true;
  }

  /// Empties the buffer into the sink. Called by the whole block.
  template <class Block>
  COLLIDE_HD_INLINE void flush(Block& block, hit_buffer<Block>& b) const {
    if constexpr (hit_buffer<Block>::capacity > 0) {
      std::uint32_t n = block.shared(b.found);
      if (n == 0) return;
      if (n > hit_buffer<Block>::capacity) n = hit_buffer<Block>::capacity;
      block.each([&](int lane) {
        if (lane != 0) return;
        b.slot = sink.reserve(n);
        b.found = 0;
      });
      block.each([&](int lane) {
        for (std::uint32_t i = static_cast<std::uint32_t>(lane); i < n; i += Block::lanes) store(b.slot + i, b.hits[i]);
      });
    }
  }

  /// Makes room for one more hit per lane.
  template <class Block>
  COLLIDE_HD_INLINE void make_room(Block& block, hit_buffer<Block>& b) const {
    if (block.shared(b.found) + Block::lanes > hit_buffer<Block>::capacity) flush(block, b);
  }

 private:
  COLLIDE_HD_INLINE void store(std::uint64_t slot, pair p) const {
    sink.store(slot, hit<NarrowPhase, S>(p, mesh, spheres));
  }
};

}  // namespace detail
}  // namespace collide
