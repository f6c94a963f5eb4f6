/// \file
/// A query in two steps, for narrow phases whose last stages take long: most pairs are decided where they are found;
/// the few that a quick attempt leaves open are listed, and decided by a kernel of their own. The kernel that goes
/// through the candidates then has no part in the rare stages: neither their registers nor their branches.
#pragma once

#include <collide/detail/atomic.hpp>
#include <collide/detail/certificate.hpp>
#include <collide/detail/hits.hpp>
#include <collide/detail/sphere_batch.hpp>
#include <collide/memory.hpp>

namespace collide::detail {

/// True for a narrow phase with a member attempt(triangle, sphere) that returns a `verdict`, `unsure` where only
/// intersects(triangle, sphere) can tell.
template <class N, class S, class = void>
struct has_attempt : std::false_type {};
template <class N, class S>
struct has_attempt<
    N, S, std::void_t<decltype(N::attempt(std::declval<triangle<S> const&>(), std::declval<sphere<S> const&>()))>>
    : std::true_type {};

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

/// The sink of the first step: as `Handle`, and pairs can be deferred.
template <class Handle>
struct deferring : Handle {
  undecided open;

  COLLIDE_HD_INLINE void defer(pair p) const {
    std::uint64_t const slot = fetch_add(open.total, std::uint64_t{1});
    if (slot < open.capacity) open.pairs[slot] = p;
  }
};

/// Kernel body of the second step: decides the pairs on the list, if all are there.
template <class S, class NarrowPhase, class Handle>
struct decide_listed {
  static constexpr int items = 1;

  tester<S, NarrowPhase, Handle> tests;
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

/// The sink of the third step, which goes through all candidates once more if the list was too short for the first.
template <class Handle>
struct completing : Handle {
  undecided open;

  COLLIDE_HD_INLINE bool needed() const { return open.overflown(); }
};

/// The narrow phase of the third step: reports the hits that the first has deferred.
template <class NarrowPhase>
struct left_open : NarrowPhase {
  template <class S>
  static COLLIDE_HD bool intersects(triangle<S> const& t, sphere<S> const& s) {
    return NarrowPhase::attempt(t, s) == verdict::unsure && NarrowPhase::intersects(t, s);
  }
};

/// Runs all steps.
template <class NarrowPhase, class Space, class Index, class S, class Handle>
void query_in_steps(Space& space, Index const& index, mesh_view<S> const& mesh, sphere_view<S> const& spheres,
                    Handle const& handle, undecided const& open) {
  index.template query<NarrowPhase>(space, spheres, deferring<Handle>{handle, open});
  decide_listed<S, NarrowPhase, Handle> body{{mesh, spheres, handle}, open, 0};
  body.blocks = smaller(space.concurrency(), blocks_for<Space>(open.capacity, body));
  space.launch(body.blocks, body);
  index.template query<left_open<NarrowPhase>>(space, spheres, completing<Handle>{handle, open});
}

}  // namespace collide::detail
