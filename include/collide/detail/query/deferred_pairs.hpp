/// \file
/// A query in two steps, for narrow phases whose last stages take long: most pairs are decided where they are found;
/// the few that a quick attempt leaves open are listed, and decided by a kernel of their own. The kernel that goes
/// through the candidates then has no part in the rare stages: neither their registers nor their calls.
#pragma once

#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/execution/launch.hpp>
#include <collide/detail/geometry/bounding_sphere.hpp>
#include <collide/detail/geometry/swept_bounds.hpp>
#include <collide/detail/narrow_phase/intersects.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/memory.hpp>

namespace collide::detail {

/// A list of pairs that were left open.
struct undecided {
  struct counters {
    std::uint64_t total;  ///< counts also pairs that found no room
    std::uint64_t ready;  ///< blocks of the second step that are done with it
  };

  counters* count;
  pair* pairs;
  std::uint64_t capacity;

  COLLIDE_HD_INLINE void add(pair p) const {
    std::uint64_t const slot = fetch_add(&count->total, std::uint64_t{1});
    if (slot < capacity) pairs[slot] = p;
  }
};

/// The memory of the list. The second step leaves it empty for the next query.
class undecided_list {
 public:
  /// The empty list, for a query of so many spheres.
  template <class Space>
  undecided begin(Space& space, std::size_t spheres) {
    constexpr std::size_t least = 1024, most = std::size_t{1} << 22;
    std::size_t const capacity = least + smaller(spheres, most);
    bool const empty = empty_ && count_.data() != nullptr;  // that of a list which was moved is not there
    auto* const count = count_.reserve(space.resource(), 1);
    if (!empty) space.fill(count, 0, sizeof *count);
    empty_ = false;
    return {count, pairs_.reserve(space.resource(), capacity), capacity};
  }

  /// To be called when both steps are on their way.
  void end() { empty_ = true; }

 private:
  buffer<undecided::counters> count_;
  buffer<pair> pairs_;
  bool empty_ = false;  ///< at least when all work that was given to the space is done
};

/// The first step: decides what a quick attempt can, and lists the rest.
template <class Handle>
struct deferring : deciding<Handle> {
  undecided open;

  template <class NarrowPhase, class S, class Ball>
  COLLIDE_HD_INLINE bool takes(pair p, triangle<S> const& t, Ball const& s) const {
    verdict const quick = in_stages<NarrowPhase>::attempt(t, s);
    if (quick == verdict::unsure) open.add(p);
    return quick == verdict::hit;
  }
};

/// The second step: what was left open. An attempt on the device has the same outcome in every kernel, as no compiler
/// is free to fuse or reorder what it computes there; so it tells which pairs of others were left open.
template <class Handle>
struct finishing : deciding<Handle> {
  bool listed;  ///< all pairs are of the list

  template <class NarrowPhase, class S, class Ball>
  COLLIDE_HD_INLINE bool takes(pair, triangle<S> const& t, Ball const& s) const {
    if (!listed && in_stages<NarrowPhase>::attempt(t, s) != verdict::unsure) return false;
    return in_stages<NarrowPhase>::finish(t, s);
  }
};

/// Kernel body of the second step: decides the pairs on the list, and ends the pass. If not all are there, it goes
/// through all pairs of spheres and triangles, plainly: that is slow, but hardly ever happens, and loses nothing.
template <class S, class NarrowPhase, class Handle>
struct finish_undecided {
  static constexpr int items = 1;

  mesh_view<S> mesh;
  spheres_of<NarrowPhase, S> spheres;
  Handle handle;
  undecided open;
  std::size_t blocks;

  template <class Block>
  struct scratch {
    hit_buffer<Block> hits;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    std::uint64_t const total = open.count->total;
    bool const listed = total <= open.capacity;
    std::uint64_t const work = listed ? total : std::uint64_t{spheres.size()} * mesh.size();
    std::uint64_t const busy = smaller<std::uint64_t>(blocks, (work + Block::lanes - 1) / Block::lanes);
    if (block.index() >= busy) {
      if (work == 0 && block.index() == 0) {
        block.each([&](int lane) {
          if (lane == 0) finish_pass(handle);
        });
      }
      return;
    }

    tester<S, NarrowPhase, finishing<Handle>> const tests{mesh, spheres, {{handle}, listed}, nullptr};
    block.each([&](int lane) { tests.begin(s.hits, lane); });
    for (std::uint64_t base = block.index() * Block::lanes; base < work; base += blocks * Block::lanes) {
      block.each([&](int lane) {
        std::uint64_t const i = base + static_cast<std::uint64_t>(lane);
        if (i >= work) return;
        if (listed) {
          tests.test(block, s.hits, open.pairs[i], spheres[open.pairs[i].sphere]);
          return;
        }
        pair const p{static_cast<id>(i / mesh.size()), static_cast<id>(i % mesh.size())};
        auto const ball = spheres[p.sphere];
        sphere<S> const around = enclosing(ball);
        if (bounds_of(mesh[p.triangle]).reached(around.centre, around.radius)) tests.test(block, s.hits, p, ball);
      });
      tests.make_room(block, s.hits);
    }
    tests.flush(block, s.hits);
    // the last block that had something to do empties the list; those that come later find it so
    block.each([&](int lane) {
      if (lane != 0 || fetch_add(&open.count->ready, std::uint64_t{1}) + 1 != busy) return;
      open.count->total = open.count->ready = 0;
      finish_pass(handle);
    });
  }
};

/// Runs both steps.
template <class NarrowPhase, class Space, class Index, class S, class Handle>
void query_in_steps(Space& space, Index const& index, mesh_view<S> const& mesh,
                    spheres_of<NarrowPhase, S> const& spheres, Handle const& handle, undecided_list& list) {
  undecided const open = list.begin(space, spheres.size());
  index.template query<NarrowPhase>(space, spheres, deferring<Handle>{{handle}, open});
  finish_undecided<S, NarrowPhase, Handle> body{mesh, spheres, handle, open, 0};
  body.blocks = smaller(larger<std::size_t>(1, space.concurrency() / 8), blocks_for<Space>(open.capacity, body));
  space.launch(body.blocks, body);
  list.end();
}

}  // namespace collide::detail
