/// \file
/// A query in two steps, for narrow phases whose last stages take long: most pairs are decided where they are found;
/// the few that a quick attempt leaves open are listed, and decided by a kernel of their own. The kernel that goes
/// through the candidates then has no part in the rare stages: neither their registers nor their branches.
#pragma once

#include <collide/detail/atomic.hpp>
#include <collide/detail/block.hpp>
#include <collide/detail/decide.hpp>
#include <collide/detail/hits.hpp>
#include <collide/memory.hpp>

namespace collide::detail {

/// A list of pairs that were left open. `total` counts also those that found no room.
struct undecided {
  std::uint64_t* total;
  pair* pairs;
  std::uint64_t capacity;

  COLLIDE_HD_INLINE bool overflown() const { return *total > capacity; }
};

/// The memory of the list.
class undecided_list {
 public:
  /// An empty list for a query of so many spheres.
  template <class Space>
  undecided clear(Space& space, std::size_t spheres) {
    constexpr std::size_t least = 1024, most = std::size_t{1} << 22;
    std::size_t const capacity = least + smaller(spheres, most);
    undecided const list{total_.reserve(space.resource(), 1), pairs_.reserve(space.resource(), capacity), capacity};
    space.fill(list.total, 0, sizeof *list.total);
    return list;
  }

 private:
  buffer<std::uint64_t> total_;
  buffer<pair> pairs_;
};

/// The first step: decides what a quick attempt can, and lists the rest.
template <class Handle>
struct deferring : deciding<Handle> {
  undecided open;

  template <class NarrowPhase, class S, class Ball>
  COLLIDE_HD_INLINE bool takes(pair p, triangle<S> const& t, Ball const& s) const {
    verdict const quick = in_stages<NarrowPhase>::attempt(t, s);
    if (quick == verdict::unsure) {
      std::uint64_t const slot = fetch_add(open.total, std::uint64_t{1});
      if (slot < open.capacity) open.pairs[slot] = p;
    }
    return quick == verdict::hit;
  }
};

/// The second step, in which all candidates are pairs of the list.
template <class Handle>
struct finishing : deciding<Handle> {
  template <class NarrowPhase, class S, class Ball>
  COLLIDE_HD_INLINE bool takes(pair, triangle<S> const& t, Ball const& s) const {
    return in_stages<NarrowPhase>::finish(t, s);
  }
};

/// The third step, if the list was too short: all candidates once more, of which it decides what the first has not.
template <class Handle>
struct completing : deciding<Handle> {
  undecided open;

  COLLIDE_HD_INLINE bool needed() const { return open.overflown(); }

  template <class NarrowPhase, class S, class Ball>
  COLLIDE_HD_INLINE bool takes(pair, triangle<S> const& t, Ball const& s) const {
    return in_stages<NarrowPhase>::attempt(t, s) == verdict::unsure && in_stages<NarrowPhase>::finish(t, s);
  }
};

/// Kernel body of the second step: decides the pairs on the list, if all are there.
template <class S, class NarrowPhase, class Handle>
struct decide_listed {
  static constexpr int items = 1;

  tester<S, NarrowPhase, finishing<Handle>> tests;
  undecided open;
  std::size_t blocks;

  template <class Block>
  struct scratch {
    hit_buffer<Block> hits;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    if (open.overflown()) return;
    tests.begin(block, s.hits);
    for (std::uint64_t base = block.index() * Block::lanes; base < *open.total; base += blocks * Block::lanes) {
      block.each([&](int lane) {
        std::uint64_t const i = base + static_cast<std::uint64_t>(lane);
        if (i < *open.total) tests.test(block, s.hits, open.pairs[i], tests.spheres[open.pairs[i].sphere]);
      });
      tests.make_room(block, s.hits);
    }
    tests.flush(block, s.hits);
  }
};

/// Runs all steps. Every pair is reported once, because an attempt on the device has the same outcome in every kernel:
/// no compiler is free to fuse or reorder what `attempt` computes there.
template <class NarrowPhase, class Space, class Index, class S, class Handle>
void query_in_steps(Space& space, Index const& index, mesh_view<S> const& mesh,
                    spheres_of<NarrowPhase, S> const& spheres, Handle const& handle, undecided const& open) {
  index.template query<NarrowPhase>(space, spheres, deferring<Handle>{{handle}, open});
  decide_listed<S, NarrowPhase, Handle> body{{mesh, spheres, {{handle}}}, open, 0};
  body.blocks = smaller(space.concurrency(), blocks_for<Space>(open.capacity, body));
  space.launch(body.blocks, body);
  index.template query<NarrowPhase>(space, spheres, completing<Handle>{{handle}, open});
}

}  // namespace collide::detail
