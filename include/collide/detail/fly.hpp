/// \file
/// The first kernel of a simulation's step: moves all particles, and lists those that may touch the mesh.
///
/// Each lane takes groups of four particles, integrates them, and asks the broad phase whether there could be a
/// triangle near. Mostly there is none, and the particle's step is done. The few others are listed for the second
/// kernel (respond.hpp), which has all the code that they need and this one has not: what most particles go through
/// takes few registers, and the others are spread evenly over the device.
#pragma once

#include <collide/detail/lookup.hpp>
#include <collide/detail/scene.hpp>

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

  particle_state<S, typename Scene::all> state;
  Scene scene;
  Lookup lookup;
  listed_particles list;
  S dt;

  template <class Block, bool Touches>
  struct scratch_of {};
  template <class Block>
  struct scratch_of<Block, true> {
    std::uint32_t count, first;
    id listed[Block::lanes * Block::items];
  };
  template <class Block>
  using scratch = scratch_of<Block, Scene::touches>;

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    if constexpr (Scene::touches) {
      block.each([&](int lane) {
        if (lane == 0) s.count = 0;
      });
      Lookup const near = lookup.opened();
      fly(block, [&](flying const& p) {
        if (p.number >= state.size || near.empty(ball_of(p))) return false;
        s.listed[block.add(s.count, 1)] = p.number;
        return true;
      });
      std::uint32_t const n = block.shared(s.count);
      if (n == 0) return;
      block.each([&](int lane) {
        if (lane == 0) s.first = fetch_add(list.count, n);
      });
      block.each([&](int lane) {
        for (auto i = static_cast<std::uint32_t>(lane); i < n; i += Block::lanes) {
          list.numbers[s.first + i] = s.listed[i];
        }
      });
    } else {
      fly(block, [](flying const&) { return false; });
    }
  }

 private:
  using flying = particle<S, typename Scene::flight>;

  template <class Block, class List>
  COLLIDE_HD_INLINE void fly(Block& block, List const& is_listed) const {
    std::size_t const first = block.index() * Block::lanes * Block::items;
    block.each([&](int lane) {
      for (int k = 0; k < Block::items; k += particles_per_group) {
        std::size_t const i = first + static_cast<std::size_t>(lane * Block::items + k);
        if (i < state.size) fly_group(i, is_listed);
      }
    });
  }

  template <class List>
  COLLIDE_HD_INLINE void fly_group(std::size_t first, List const& is_listed) const {
    bool skipped[particles_per_group] = {};
    if constexpr (Scene::skips) {
      particle<S, typename Scene::skipping> p[particles_per_group];
      state.load_group(p, first);
      bool all = true;
      for (int k = 0; k < particles_per_group; ++k) {
        skipped[k] = first + static_cast<std::size_t>(k) >= state.size || scene.is_skipped(p[k]);
        all = all && skipped[k];
      }
      if (all) return;
    }
    flying p[particles_per_group];
    state.load_group(p, first);
    for (int k = 0; k < particles_per_group; ++k) {
      if (skipped[k]) continue;
      if constexpr (part_before != 0) scene.accelerate(p[k], part_before * dt);
      if constexpr (!moves) p[k][position{}] += p[k][velocity{}] * dt;
      if (is_listed(p[k])) continue;
      if constexpr (moves) p[k][position{}] += p[k][velocity{}] * dt;
      if constexpr (part_after != 0) scene.accelerate(p[k], part_after * dt);
      scene.finish(p[k], dt);
    }
    state.store_group(p, first, typename Scene::flight_writes{});
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
