/// \file
/// The first part of a simulation's step: moves all particles, and lists those that may touch the mesh.
///
/// Each lane takes groups of four particles, integrates them, and asks the broad phase whether there could be a
/// triangle near. Mostly there is none, and the particle's step is done. The few others are listed for the second part
/// (respond.hpp). Lanes that work alone have a kernel for each part, and one list: what most particles go through then
/// takes few registers, and the others are spread evenly over the device. Lanes that work together go on with what
/// their own block has listed (step.hpp).
#pragma once

#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/execution/block.hpp>
#include <collide/detail/execution/multiversion.hpp>
#include <collide/detail/grid/grid_ref.hpp>
#include <collide/detail/narrow_phase/traits.hpp>
#include <collide/detail/simulation/effect_list.hpp>

namespace collide::detail {

/// The particles that may touch the mesh in a step, in memory of the space. Where lanes work together, only those that
/// their block has no room for.
struct listed_particles {
  std::uint32_t* count;  ///< of the one list that lanes have that work alone,
  std::uint32_t* done;   ///< and blocks that have finished with it: the last one empties it for the next step
  id* numbers;           ///< room for all particles and their padding
};

/// Kernel body: moves all particles. `NarrowPhase` judges balls at rest, or balls that move: then those that are listed
/// stay where they were.
template <class S, class NarrowPhase, class Lookup, class Scene>
struct fly_body {
  static constexpr int items = particles_per_group;
  static constexpr bool moves = !at_rest<NarrowPhase, S>;
  static constexpr S part_before = S(Scene::integrator::before), part_after = S(Scene::integrator::after);

  /// How many particles a lane moves at a time: a group, which compilers put into vector registers, or as many as are
  /// asked together whether they are near the mesh.
  template <class Block>
  static constexpr int at_a_time = Block::items % 16 == 0 && Scene::touches ? 16 : particles_per_group;
  static_assert(particle_padding % 16 == 0, "the last ones are read and written with those that are not there");

  using state_type = particle_state<S, typename Scene::all>;

  state_type state;
  Scene scene;
  Lookup lookup;
  listed_particles list;
  S dt;
  bool backwards;  ///< the last particles first: what the step before has moved last is still in the caches
  S least_radius;  ///< particles that are swept are looked for as if they were at least so large

  template <class Block>
  using group_scratch = typename state_type::template group_scratch<Block>;
  template <class Block, bool Touches>
  struct scratch_of {
    group_scratch<Block> groups;
  };
  template <class Block>
  struct scratch_of<Block, true> : scratch_of<Block, false> {
    std::uint32_t count;
    id listed[Block::items];
  };
  template <class Block>
  using scratch = scratch_of<Block, Scene::touches>;

  /// True if all particles are asked in the same way whether they can touch a triangle: by `cell_marks`.
  COLLIDE_HD_INLINE bool marks_all() const {
    return has_one_radius && lookup.is_simple(larger(state.common_radius, least_radius));
  }

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    if constexpr (Scene::touches) {
      static_assert(Block::lanes == 1, "lanes that work together have one kernel for both parts");
      s.count = 0;
      Lookup const near = lookup.opened();
      bool const simple = marks_all();
      auto const marks = lookup.marks();
      auto const list_one = [&](id number) { s.listed[s.count++] = number; };
      auto const opened = [at = &near]() -> Lookup const& { return *at; };
      auto const list_near = lister(simple, marks, opened, list_one);
      if constexpr (lists_afterwards<Block>) {
        if (simple) {
          fly<group>(block, s.groups, list_none{});
          vectorised([&] { list_marked<Block::items>(first_of<Block>(block.index()), marks, list_one); });
        } else {
          fly<at_a_time<Block>>(block, s.groups, list_near);
        }
      } else {
        fly<at_a_time<Block>>(block, s.groups, list_near);
      }
      if (s.count == 0) return;
      std::uint32_t const first = fetch_add(list.count, s.count);
      for (std::uint32_t i = 0; i < s.count; ++i) list.numbers[first + i] = s.listed[i];
    } else {
      fly<at_a_time<Block>>(block, s.groups, list_none{});
    }
  }

 protected:
  using flying = particle<S, typename Scene::flight>;
  static constexpr int group = particles_per_group;

  static constexpr bool has_one_radius = !contains<typename Scene::all, radius>;

  /// On a CPU, where nothing happens to particles after they have moved, they are asked afterwards whether they may
  /// touch the mesh, as many as fill its vector registers at a time.
  template <class Block>
  static constexpr bool lists_afterwards =
      Block::items % 16 == 0 && !moves && has_one_radius && !Scene::skips && !Scene::finishes && part_after == 0;

  struct list_none {
    template <class Particles, class Flags>
    COLLIDE_HD_INLINE void operator()(Particles const&, Flags const&, Flags const&) const {}
  };

  /// Calls list(number) for those of `N` particles that may touch the mesh, from where they are now.
  template <int N, class List>
  void list_marked(std::size_t first, cell_marks<S> const& marks, List const& list) const {
    sphere_batch<S, N> batch;
    batch.load(
        sphere_view<S>{spheres_xyz(static_cast<S const*>(state.at(position{})), state.size, state.common_radius)},
        first);
    auto const places = marks.places_of(batch.x, batch.y, batch.z);
    for (int k = 0; k < N; ++k) {
      if (places.inside[k] == 0 || !marks.is_marked(places.cells[k])) continue;
      list(static_cast<id>(first) + static_cast<id>(k));
    }
  }

  /// The first particle of a block.
  template <class Block>
  COLLIDE_HD_INLINE std::size_t first_of(std::size_t block) const {
    constexpr auto share = static_cast<std::size_t>(Block::lanes) * Block::items;
    return (backwards ? (state.size - 1) / share - block : block) * share;
  }

  /// What `move_some` calls: for those of some particles that may touch the mesh, sets listed[k], and calls
  /// list(number). If all are `simple`, they are asked `marks`. `near()` is the opened lookup.
  template <class Near, class List>
  COLLIDE_HD_INLINE auto lister(bool const& simple, cell_marks<S> const& marks, Near const& near,
                                List const& list) const {
    return [&, near, size = state.size](auto const& p, auto const& skipped, auto& listed) {
      constexpr int n = sizeof(listed) / sizeof(listed[0]);
      if (!simple || !mark_near(marks, p, listed)) ask_each(near(), p, listed);
      for (int k = 0; k < n; ++k) {
        listed[k] = listed[k] && !skipped[k] && p[k].number < size;
        if (listed[k]) list(p[k].number);
      }
    };
  }

  /// Moves the particles of a block, a lane `n` at a time. `list_some(particles, skipped, listed)` sets listed[k] for
  /// those that may touch the mesh.
  template <int n, class Block, class Groups, class List>
  COLLIDE_HD_INLINE void fly(Block& block, Groups& groups, List const& list_some) const {
    std::size_t const first = first_of<Block>(block.index());
    block.each([&](int lane) {
      for (int k = 0; k < Block::items; k += n) {
        std::size_t const i = first + static_cast<std::size_t>(lane * Block::items + k);
        if constexpr (Scene::skips) {
          fly_alone<n>(block.index(), i, list_some);
        } else {
          static_assert(n == Block::items || Block::row_lanes == 1, "rows follow each other from lane to lane");
          static_assert(Block::row_lanes == 1 || particle_padding % (std::size_t{Block::lanes} * Block::items) == 0,
                        "there is room for all that a block reads and writes");
          if (Block::row_lanes > 1 || i < state.size) fly_some<n>(block, groups, i, list_some);
        }
      }
    });
  }

  /// A lane alone moves some particles: of those that are left out nothing is read.
  template <int N, class List>
  COLLIDE_HD_INLINE void fly_alone(std::size_t block, std::size_t first, List const& list_some) const {
    serial_block<N, 0> alone(block);
    group_scratch<serial_block<N, 0>> none;
    if (first < state.size) fly_some<N>(alone, none, first, list_some);
  }

  template <int N, class Block, class Groups, class List>
  COLLIDE_HD_INLINE void fly_some(Block& block, Groups& groups, std::size_t first, List const& list_some) const {
    auto const load = [&](auto* p) {
      for (int k = 0; k < N; k += group) state.load_group(block, groups, p + k, first + static_cast<std::size_t>(k));
    };
    bool skipped[N] = {};
    if constexpr (Scene::skips) {
      particle<S, typename Scene::skipping> p[N];
      load(p);
      bool all = true;
      for (int k = 0; k < N; ++k) {
        skipped[k] = first + static_cast<std::size_t>(k) >= state.size || scene.is_skipped(p[k]);
        all = all && skipped[k];
      }
      if (all) return;
    }
    flying p[N];
    load(p);
    move_some(block, groups, first, p, skipped, list_some);
  }

  /// Moves some particles that are read, those that are not skipped.
  template <int N, class Block, class Groups, class List>
  COLLIDE_HD_INLINE void move_some(Block& block, Groups& groups, std::size_t first, flying (&p)[N],
                                   bool const (&skipped)[N], List const& list_some) const {
    bool listed[N] = {};
    for (int k = 0; k < N; ++k) {
      if (skipped[k]) continue;
      if constexpr (part_before != 0) scene.accelerate(p[k], part_before * dt);
      if constexpr (!moves) p[k][position{}] += p[k][velocity{}] * dt;
    }
    list_some(p, skipped, listed);
    for (int k = 0; k < N; ++k) {
      if (skipped[k] || listed[k]) continue;
      if constexpr (moves) p[k][position{}] += p[k][velocity{}] * dt;
      if constexpr (part_after != 0) scene.accelerate(p[k], part_after * dt);
      scene.finish(p[k], dt);
    }
    for (int k = 0; k < N; k += group) {
      state.store_group(block, groups, p + k, first + static_cast<std::size_t>(k), typename Scene::flight_writes{});
    }
  }

  /// Of one radius and in one grid of one level: without branches, for the CPU's vector unit, as which particles are
  /// near the mesh is not to be foreseen. False if it is not known: one of them goes a long way.
  template <int N>
  COLLIDE_HD_INLINE bool mark_near(cell_marks<S> const& marks, flying const (&p)[N], bool (&listed)[N]) const {
    moving_batch<S, N> ways;
    for (int k = 0; k < N; ++k) {
      vec3<S> const& c = p[k][position{}];
      ways.x[k] = c.x(), ways.y[k] = c.y(), ways.z[k] = c.z();
      if constexpr (moves) {
        vec3<S> const d = p[k][velocity{}] * dt;
        ways.dx[k] = d.x(), ways.dy[k] = d.y(), ways.dz[k] = d.z();
      }
    }
    if constexpr (moves) {
      return marks.mark_ways(ways, listed);
    } else {
      marks.mark(marks.places_of(ways.x, ways.y, ways.z), listed);
      return true;
    }
  }

  /// In any grids. The long code goes round: what it indexes is not in registers, so they are copies.
  template <int N>
  COLLIDE_HD_INLINE void ask_each(Lookup const& near, flying const (&p)[N], bool (&listed)[N]) const {
    decltype(ball_of(p[0])) balls[N];
    for (int k = 0; k < N; ++k) balls[k] = ball_of(p[k]);
    std::uint32_t found = 0;
    COLLIDE_ROLLED
    for (int k = 0; k < N; ++k) found |= near.empty(balls[k]) ? 0u : 1u << k;
    for (int k = 0; k < N; ++k) listed[k] = (found >> k & 1) != 0;
  }

  /// What the narrow phase judges.
  COLLIDE_HD_INLINE auto ball_of(flying const& p) const {
    if constexpr (moves) {
      S const radius = p.the_radius >= 0 ? larger(p.the_radius, least_radius) : p.the_radius;
      return moving_sphere<S>{{p[position{}], radius}, p[velocity{}] * dt};
    } else {
      return sphere<S>{p[position{}], p.the_radius};
    }
  }
};

}  // namespace collide::detail
