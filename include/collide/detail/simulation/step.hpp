/// \file
/// A simulation's step where lanes work together: each block moves its share of the particles, and then resolves the
/// contacts of those that may touch the mesh.
///
/// There are as many blocks as can be at work at the same time. Each has its particles from everywhere among their
/// numbers, as those that are close to each other there may be close to the mesh together; so all have about as many
/// contacts to resolve, and none waits for another.
#pragma once

#include <collide/detail/simulation/contact_response.hpp>

namespace collide::detail {

/// Kernel body: a step, in `blocks` blocks.
template <class S, class NarrowPhase, class Lookup, class Scene>
struct step_body : respond_body<S, NarrowPhase, Lookup, Scene> {
  using respond_type = respond_body<S, NarrowPhase, Lookup, Scene>;
  using fly_type = typename respond_type::fly_type;
  using respond_type::backwards;
  using respond_type::blocks;
  using respond_type::list;
  using respond_type::lookup;
  using respond_type::moves;
  using respond_type::state;

  static constexpr int items = particles_per_group;
  template <class Block>
  static constexpr int residency = 3;  ///< waits for memory, mostly

  /// What neighbouring lanes have of the particles, as they read and write together: all particles are so many
  /// stretches. A block has every `blocks`-th of them.
  template <class Block>
  static constexpr std::uint32_t stretch = std::uint32_t{Block::row_lanes} * items;
  template <class Block>
  static COLLIDE_HD_INLINE std::uint32_t stretches(std::size_t particles) {
    return static_cast<std::uint32_t>((particles + stretch<Block> - 1) / stretch<Block>);
  }

  /// True if the next particles are on their way while a lane moves some. To ask for the cells of ways takes too many
  /// registers for that.
  static constexpr bool reads_ahead = !moves && !Scene::skips;

  /// For how many particles that may touch the mesh a block has room: as many as it resolves at a time.
  template <class Block>
  static constexpr std::uint32_t room = respond_type::template together<Block>;

  template <class Block>
  struct scratch {
    union {  // one after the other
      typename fly_type::template group_scratch<Block> groups;
      typename respond_type::template scratch<Block> contacts;
    };
    cell_marks<S> marks;
    bool simple;  ///< all are asked `marks` whether they may touch the mesh
    std::uint32_t count;
    id listed[room<Block>];  ///< the first of those that may
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    static_assert(particle_padding % stretch<Block> == 0, "there is room for all that a block reads and writes");
    move_share(block, s);
    std::uint32_t const n = block.shared(s.count);
    if (n == 0) return;
    Lookup const near = lookup.opened();
    std::uint32_t const share = (n - 1) / ((n - 1) / room<Block> + 1) + 1;
    for (std::uint32_t base = 0; base < n; base += share) {
      this->collide(block, s.contacts, near, smaller(n - base, share),
                    [&](survivor<S, moves>& one, std::uint32_t j) { begin(block, s, one, base + j); });
    }
  }

 private:
  /// The number of a block's `k`-th stretch.
  template <class Block>
  COLLIDE_HD_INLINE std::uint32_t stretch_of(Block const& block, std::uint32_t k) const {
    return k * static_cast<std::uint32_t>(blocks) + static_cast<std::uint32_t>(block.index());
  }

  /// Where in the list of all particles a block lists its `i`-th for which it has no room: where its own stretches
  /// would be.
  template <class Block>
  COLLIDE_HD_INLINE std::size_t place_of(Block const& block, std::uint32_t i) const {
    return std::size_t{stretch_of(block, i / stretch<Block>)} * stretch<Block> + i % stretch<Block>;
  }

  /// What is known of the `i`-th particle that a block has listed.
  template <class Block>
  COLLIDE_HD_INLINE void begin(Block const& block, scratch<Block> const& s, survivor<S, moves>& one,
                               std::uint32_t i) const {
    respond_type::begin(one, i < room<Block> ? s.listed[i] : list.numbers[place_of(block, i - room<Block>)]);
  }

  /// Moves the particles of a block, and lists those that may touch the mesh.
  template <class Block>
  COLLIDE_HD_INLINE void move_share(Block& block, scratch<Block>& s) const {
    constexpr std::uint32_t row = Block::row_lanes, rows = Block::lanes / row;
    std::uint32_t const n = stretches<Block>(state.size);
    auto const list_one = [&](id number) {
      std::uint32_t const i = block.add(s.count, 1);
      if (i < room<Block>) {
        s.listed[i] = number;
      } else {
        list.numbers[place_of(block, i - room<Block>)] = number;
      }
    };
    auto const list_some = this->lister(
        s.simple, s.marks, [&] { return lookup.opened(); }, list_one);
    // a lane's particles of a stretch; in place of one that does not exist, of the last
    auto const first_of = [&](int lane, std::uint32_t i) {
      std::uint32_t const in = smaller(i, n - 1);
      return (backwards ? n - 1 - in : in) * stretch<Block> + static_cast<std::uint32_t>(lane) % row * items;
    };
    auto const begin_of = [&](int lane) { return stretch_of(block, static_cast<std::uint32_t>(lane) / row); };
    block.each([&](int lane) {
      if (lane != 0) return;
      s.count = 0;
      s.simple = this->marks_all();
      s.marks = lookup.marks();
    });
    block.each([&](int lane) {
      typename fly_type::state_type::template group_of<typename Scene::flight> read;
      if constexpr (reads_ahead) state.begin_group(block, read, first_of(lane, begin_of(lane)));
      COLLIDE_ROLLED
      for (std::uint32_t i = begin_of(lane), next; i < n; i = next) {
        next = i + rows * static_cast<std::uint32_t>(blocks);
        if constexpr (Scene::skips) {
          this->template fly_alone<items>(block.index(), first_of(lane, i), list_some);
        } else {
          typename fly_type::flying p[items];
          bool const skipped[items] = {};
          if constexpr (!reads_ahead) state.begin_group(block, read, first_of(lane, i));
          state.end_group(block, s.groups, read, p, first_of(lane, i));
          if constexpr (reads_ahead) state.begin_group(block, read, first_of(lane, next));
          this->move_some(block, s.groups, first_of(lane, i), p, skipped, list_some);
        }
      }
    });
  }
};

}  // namespace collide::detail
