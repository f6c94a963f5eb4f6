/// \file
/// The first kernel of a simulation's step: moves all particles, and lists those that may touch the mesh.
///
/// Each lane takes groups of four particles, integrates them, and asks the broad phase whether there could be a
/// triangle near. Mostly there is none, and the particle's step is done. The few others are listed for the second
/// kernel (respond.hpp), which has all the code that they need and this one has not: what most particles go through
/// takes few registers, and the others are spread evenly over the device.
#pragma once

#include <collide/detail/atomic.hpp>
#include <collide/detail/block.hpp>
#include <collide/detail/lookup.hpp>
#include <collide/detail/scene.hpp>
#include <collide/detail/spheres_of.hpp>
#include <collide/detail/vectorised.hpp>

namespace collide::detail {

/// The particles that may touch the mesh in a step, in memory of the space.
struct listed_particles {
  std::uint32_t* count;
  std::uint32_t* done;  ///< blocks that have finished with the list: the last one empties it for the next step
  id* numbers;          ///< room for all particles
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

  template <class Block, bool Touches>
  struct scratch_of {
    typename state_type::template group_scratch<Block> groups;
  };
  template <class Block>
  struct scratch_of<Block, true> : scratch_of<Block, false> {
    std::uint32_t count, first;
    id listed[Block::lanes * Block::items];
  };
  template <class Block>
  using scratch = scratch_of<Block, Scene::touches>;

  /// True if all particles are asked in the same way whether they can touch a triangle: by `cell_marks`.
  static COLLIDE_HD_INLINE bool marks_all(Lookup const& lookup, state_type const& state) {
    return !moves && has_one_radius && lookup.is_simple(state.common_radius);
  }

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    if constexpr (Scene::touches) {
      block.each([&](int lane) {
        if (lane == 0) s.count = 0;
      });
      Lookup const near = lookup.opened();
      bool const simple = marks_all(lookup, state);
      auto const marks = lookup.marks();
      constexpr int n = at_a_time<Block>;
      auto const list_near = [&](auto const& p, auto const& skipped, auto& listed) {
        if (simple) {
          mark_near(marks, p, listed);
        } else {
          for (int k = 0; k < n; ++k) listed[k] = !near.empty(ball_of(p[k]));
        }
        for (int k = 0; k < n; ++k) {
          listed[k] = listed[k] && !skipped[k] && p[k].number < state.size;
          if (listed[k]) s.listed[block.add(s.count, 1)] = p[k].number;
        }
      };
      if constexpr (lists_afterwards<Block>) {
        if (simple) {
          fly<group>(block, s.groups, list_none{});
          vectorised([&] { list_marked(block, s, marks); });
        } else {
          fly<n>(block, s.groups, list_near);
        }
      } else {
        fly<n>(block, s.groups, list_near);
      }
      std::uint32_t const found = s.count;
      if (found == 0) return;
      block.each([&](int lane) {
        if (lane == 0) s.first = fetch_add(list.count, found);
      });
      block.each([&](int lane) {
        for (auto i = static_cast<std::uint32_t>(lane); i < found; i += Block::lanes) {
          list.numbers[s.first + i] = s.listed[i];
        }
      });
    } else {
      fly<at_a_time<Block>>(block, s.groups, list_none{});
    }
  }

 private:
  using flying = particle<S, typename Scene::flight>;
  static constexpr int group = particles_per_group;

  static constexpr bool has_one_radius = !contains<typename Scene::all, radius>;

  /// On a CPU, where nothing happens to particles after they have moved, they are asked afterwards whether they may
  /// touch the mesh, as many as fill its vector registers at a time.
  template <class Block>
  static constexpr bool lists_afterwards = Block::lanes == 1 && Block::items % 16 == 0 && !moves && has_one_radius &&
                                           !Scene::skips && !Scene::finishes && part_after == 0;

  struct list_none {
    template <class Particles, class Flags>
    COLLIDE_HD_INLINE void operator()(Particles const&, Flags const&, Flags const&) const {}
  };

  /// Lists those of a block's particles that may touch the mesh, from where they are now.
  template <class Block>
  void list_marked(Block& block, scratch<Block>& s, cell_marks<S> const& marks) const {
    constexpr int n = Block::items;
    std::size_t const first = first_of<Block>(block.index());
    sphere_batch<S, n> batch;
    batch.load(
        sphere_view<S>{spheres_xyz(static_cast<S const*>(state.at(position{})), state.size, state.common_radius)},
        first);
    auto const places = marks.places_of(batch.x, batch.y, batch.z);
    for (int k = 0; k < n; ++k) {
      if (places.inside[k] == 0 || !marks.is_marked(places.cells[k])) continue;
      s.listed[s.count++] = static_cast<id>(first) + static_cast<id>(k);
    }
  }

  /// The first particle of a block.
  template <class Block>
  COLLIDE_HD_INLINE std::size_t first_of(std::size_t block) const {
    constexpr auto share = static_cast<std::size_t>(Block::lanes) * Block::items;
    return (backwards ? (state.size - 1) / share - block : block) * share;
  }

  /// Moves the particles of a block, a lane `n` at a time. `list_some(particles, skipped, listed)` sets listed[k] for
  /// those that may touch the mesh.
  template <int n, class Block, class Groups, class List>
  COLLIDE_HD_INLINE void fly(Block& block, Groups& groups, List const& list_some) const {
    std::size_t const first = first_of<Block>(block.index());
    block.each([&](int lane) {
      for (int k = 0; k < Block::items; k += n) {
        std::size_t const i = first + static_cast<std::size_t>(lane * Block::items + k);
        if constexpr (Scene::skips) {  // nothing is read of those that are left out
          serial_block<Block::items, 0> alone(block.index());
          typename state_type::template group_scratch<decltype(alone)> none;
          if (i < state.size) fly_some<n>(alone, none, i, list_some);
        } else {
          static_assert(n == Block::items || Block::row_lanes == 1, "rows follow each other from lane to lane");
          if (Block::row_lanes > 1 || i < state.size) fly_some<n>(block, groups, i, list_some);
        }
      }
    });
  }

  template <int N, class Block, class Groups, class List>
  COLLIDE_HD_INLINE void fly_some(Block& block, Groups& groups, std::size_t first, List const& list_some) const {
    auto const load = [&](auto* p) {
      for (int k = 0; k < N; k += group) state.load_group(block, groups, p + k, first + static_cast<std::size_t>(k));
    };
    bool skipped[N] = {}, listed[N] = {};
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
  /// near the mesh is not to be foreseen.
  template <int N, class Marks>
  static COLLIDE_HD_INLINE void mark_near(Marks const& marks, flying const (&p)[N], bool (&listed)[N]) {
    S x[N], y[N], z[N];
    for (int k = 0; k < N; ++k) {
      vec3<S> const& c = p[k][position{}];
      x[k] = c.x(), y[k] = c.y(), z[k] = c.z();
    }
    marks.mark(marks.places_of(x, y, z), listed);
  }

  /// What the narrow phase judges.
  COLLIDE_HD_INLINE auto ball_of(flying const& p) const {
    if constexpr (moves) {
      return moving_sphere<S>{{p[position{}], p.the_radius}, p[velocity{}] * dt};
    } else {
      return sphere<S>{p[position{}], p.the_radius};
    }
  }
};

}  // namespace collide::detail
