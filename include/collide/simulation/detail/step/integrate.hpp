/// \file
/// Time integration: the half kicks of a step, and the motion of particles, some at a time, up to where they may touch
/// the mesh.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/simulation/detail/step/mesh_ledger.hpp>
#include <collide/spaces/detail/block.hpp>

// the numbers of elements of small arrays are int
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion"

namespace collide::detail {

/// The part of a step's acceleration with which it begins: what the mesh held at the end of the last step still has to
/// get the second half of that.
template <class Context, class Particle>
COLLIDE_HD_INLINE auto first_kick([[maybe_unused]] Particle const& p) {
  if constexpr (contains<typename Particle::list, held>)
    return p[held{}] == owes_a_kick ? Context::kick_before + Context::kick_after : Context::kick_before;
  return Context::kick_before;
}

/// The beginning of a particle's step. Returns for how long all accelerate it in the first kick: 0 if the mesh holds
/// it, or it is of a clump.
template <class Context, class Particle>
COLLIDE_HD_INLINE auto begin_with_kick(Context const& context, Particle& p) {
  using S = typename Context::scalar;
  if constexpr (Context::effects_type::keeps_support) {
    auto const n = S(steps_in_mean(p[slow_steps{}]));
    for_each_support(p, [&](vec3<S>& of, std::uint8_t& by) {
      of = of * ((n - 1) / n);
      if (n == 1) by = 0;
    });
  }
  if (is_of_clump(p)) return S(0);
  S const kick = first_kick<Context>(p);
  if constexpr (Context::effects_type::adheres) {
    if (is_stuck(p[adhered{}]) && carry_stuck(context, p, kick)) return S(0);
  }
  if constexpr (contains<typename Particle::list, held>) p[held{}] = 0;
  return kick;
}
template <class Context, class Particle>
COLLIDE_HD_INLINE void begin_particle(Context const& context, Particle& p) {
  auto const kick = begin_with_kick(context, p);
  if (kick != 0) context.effects.accelerate(p, kick * context.dt);
}

/// Says that a particle has come to the end of its step, and whether the mesh `holds` it there.
template <class Context, class Particle>
COLLIDE_HD_INLINE void end_motion([[maybe_unused]] Context const& context, [[maybe_unused]] Particle& p,
                                  [[maybe_unused]] bool holds) {
  if constexpr (Context::effects_type::adheres && Context::has_bodies && Context::is_swept) {
    if (int const frame = frame_ridden(p)) {
      auto const& f = context.triangles.mesh.frames[frame];
      using S = typename Context::scalar;
      vec3<S> const before = p[velocity{}];
      p[velocity{}] = rounded_to<S>(velocity_at(f.moving, f.now, p[position{}].template cast<double>()));
      if (p.number < context.state.size) record_stuck(context, p, p[velocity{}] - before);
    }
  }
  if constexpr (contains<typename Particle::list, held>) {
    if constexpr (Context::effects_type::adheres) {
      if (p[held{}] == stuck_all_along && is_stuck(p[adhered{}])) return;  // it stuck all the time
    }
    p[held{}] = holds ? owes_a_kick : std::uint8_t{0};
  }
}

/// The part of a step's acceleration with which it ends, of a particle that the mesh does not hold.
template <class Context, class Particle>
COLLIDE_HD_INLINE auto last_kick([[maybe_unused]] Particle const& p) {
  if constexpr (contains<typename Particle::list, held>)
    return p[held{}] == owes_a_kick ? typename Context::scalar(0) : Context::kick_after;
  return Context::kick_after;
}

/// The end of a particle's step: the second kick, and what effects do last.
template <class Context, class Particle>
COLLIDE_HD_INLINE void end_particle(Context const& context, Particle& p) {
  if constexpr (Context::kick_after != 0) {
    int by = 0;
    if constexpr (contains<typename Particle::list, held>) by = p[held{}];
    if (by == 0 && !is_of_clump(p)) context.effects.accelerate(p, Context::kick_after * context.dt);
    if constexpr (Context::effects_type::adheres) {
      if (by == stuck_all_along) {
        Particle next = p;
        context.effects.accelerate(next, Context::kick_after * context.dt);
        record_stuck(context, p, p[velocity{}] - next[velocity{}]);
        if constexpr (contains<typename Particle::list, pair_angular_acceleration>)
          p[angular_velocity{}] = next[angular_velocity{}];
      }
    }
  }
  context.effects.end_step(p, context.dt);
}

/// Bit k is set if shape k may touch a triangle. `triangles` is a look-up that is opened.
template <class Triangles, class Shape, int N>
COLLIDE_HD_LINKED std::uint32_t near_triangles(Triangles const& triangles, Shape const (&shapes)[N]) {
  std::uint32_t found = 0;
  COLLIDE_NO_UNROLL
  for (int k = 0; k < N; ++k) found |= triangles.empty(shapes[k]) ? 0u : 1u << k;
  return found;
}

/// In place of a mesh filter, where nothing touches the mesh.
struct no_filter {
  template <class Particles, class Flags>
  COLLIDE_HD_INLINE void operator()(Particles const&, Flags const&, Flags const&) const {}
};

/// Time integration: the work of a thread for the particles that it moves.
template <class Context>
struct integration {
  using S = typename Context::scalar;
  using effects_type = typename Context::effects_type;
  using state_type = typename Context::state_type;
  using triangles_type = typename Context::triangles_type;
  using integrated = particle<S, typename effects_type::integration_reads>;
  using loaded_pack = typename state_type::template pack_of<typename effects_type::integration_reads>;
  template <class Block>
  using scratch = typename state_type::template pack_scratch<Block>;

  static constexpr int pack = particles_per_pack;  ///< particles that are read or written together
  static constexpr bool has_one_radius = !contains<typename effects_type::all, radius>;
  static constexpr bool is_swept = Context::is_swept;
  static constexpr bool has_bodies = Context::has_bodies;
  static constexpr bool may_ride = has_bodies && effects_type::adheres;

  Context const& context;

  /// Moves `N` particles from number `first` on. `filter(particles, inactive, near)` sets near[k] for those that may
  /// touch the mesh: for these the step is not over.
  template <int N, class Block, class Filter>
  COLLIDE_HD_INLINE void advance(Block& block, scratch<Block>& s, std::size_t first, Filter const& filter) const {
    if constexpr (effects_type::any_inactive) {  // each thread alone: of particles that are left out nothing is read
      serial_block<N, 0> alone(block.index());
      scratch<serial_block<N, 0>> none;
      if (first < context.state.size) advance_active<N>(alone, none, first, filter);
    } else if (Block::warp_size > 1 || first < context.state.size) {
      bool const inactive[N] = {};
      integrated p[N];
      load(block, s, p, first);
      integrate(block, s, first, p, inactive, filter);
    }
  }

  /// Moves a pack that is loaded.
  template <int N, class Block, class Filter>
  COLLIDE_HD_INLINE void integrate(Block& block, scratch<Block>& s, std::size_t first, integrated (&p)[N],
                                   bool const (&inactive)[N], Filter const& filter) const {
    auto const& state = context.state;
    bool near[N] = {};
    if constexpr (effects_type::any_resistance && N % 16 == 0) {  // on a CPU
      S times[N];
      for (int k = 0; k < N; ++k) times[k] = inactive[k] ? S(0) : begin_with_kick(context, p[k]) * context.dt;
      context.effects.accelerate_together(p, times);
    }
    COLLIDE_UNROLL
    for (int k = 0; k < N; ++k) {
      if (inactive[k]) continue;
      if constexpr (!(effects_type::any_resistance && N % 16 == 0)) begin_particle(context, p[k]);
      if constexpr (!is_swept) move(p[k]);
    }
    filter(p, inactive, near);
    for (int k = 0; k < N; ++k) {
      if (inactive[k] || near[k]) continue;
      if constexpr (is_swept) p[k][position{}] += p[k][velocity{}] * context.dt;
      end_motion(context, p[k], false);
      if constexpr (!effects_type::ends_after_meeting) end_particle(context, p[k]);
    }
    for (int k = 0; k < N; k += pack) {
      state.store_pack(block, s, p + k, first + static_cast<std::size_t>(k),
                       typename effects_type::integration_writes{});
    }
  }

  COLLIDE_HD_INLINE void move(integrated& p) const {
    if constexpr (may_ride) {
      if (int const frame = frame_ridden(p)) {
        vec3<double> const x = p[position{}].template cast<double>();
        p[position{}] = rounded_to<S>(carried(context.triangles.mesh.frames[frame], x));
        return;
      }
    }
    p[position{}] += p[velocity{}] * context.dt;
  }

  /// True if `occupancy` alone tell whether a particle can touch a triangle.
  COLLIDE_HD_INLINE bool is_single_cell() const {
    return has_one_radius && !(has_bodies && is_swept) &&
           context.triangles.has_single_cell_lookup(max(context.state.common_radius, context.min_radius));
  }

  /// Sets near[k] for those of some particles that may touch the mesh.
  template <int N>
  COLLIDE_HD_INLINE void test_occupancy(bool single_cell, occupancy_view<S> const& occupancy, integrated const (&p)[N],
                                        bool (&near)[N]) const {
    if (!single_cell || !test_occupied(occupancy, p, near)) test_each(p, near);
  }

  /// Calls enqueue(number) for those of `N` particles in memory from number `first` on that may touch the mesh, from
  /// where they are now.
  template <int N, class Enqueue>
  void enqueue_occupied(std::size_t first, occupancy_view<S> const& occupancy, Enqueue const& enqueue) const {
    auto const& state = context.state;
    sphere_pack<S, N> batch;
    batch.load(
        sphere_view<S>{spheres_xyz(static_cast<S const*>(state.at(position{})), state.size, state.common_radius)},
        first);
    if constexpr (has_bodies) {
      bool near[N];
      bool const known =
          context.triangles.test_occupied(occupancy, batch.x, batch.y, batch.z, state.common_radius, near);
      auto const triangles = context.triangles.opened();
      for (int k = 0; k < N && first + static_cast<std::size_t>(k) < state.size; ++k) {
        if (known ? near[k] : !triangles.empty(batch.shape(k))) enqueue(static_cast<id>(first) + static_cast<id>(k));
      }
      return;
    }
    auto const places = occupancy.places_of(batch.x, batch.y, batch.z);
    for (int k = 0; k < N; ++k) {
      if (places.inside[k] == 0 || !occupancy.is_occupied(places.cells[k])) continue;
      enqueue(static_cast<id>(first) + static_cast<id>(k));
    }
  }

 private:
  /// Moves those of `N` particles that no effect leaves out.
  template <int N, class Block, class Filter>
  COLLIDE_HD_INLINE void advance_active(Block& block, scratch<Block>& s, std::size_t first,
                                        Filter const& filter) const {
    bool inactive[N];
    particle<S, typename effects_type::inactive_reads> maybe_inactive[N];
    load(block, s, maybe_inactive, first);
    bool all = true;
    [[maybe_unused]] bool woken[N] = {};
    for (int k = 0; k < N; ++k) {
      std::size_t const i = first + static_cast<std::size_t>(k);
      inactive[k] = i >= context.state.size || context.effects.is_inactive(maybe_inactive[k]);
      if constexpr (may_wake) {
        woken[k] = i < context.state.size && inactive[k] && is_woken(maybe_inactive[k], i);
        inactive[k] = inactive[k] && !woken[k];
      }
      if constexpr (effects_type::keeps_support) {
        if (i < context.state.size && inactive[k] && context.effects.only_sleeps(maybe_inactive[k])) press(i);
      }
      all = all && inactive[k];
    }
    if (all) return;
    integrated p[N];
    load(block, s, p, first);
    if constexpr (may_wake) {
      for (int k = 0; k < N; ++k) {
        if (woken[k]) p[k][slow_steps{}] = 0;
      }
    }
    integrate(block, s, first, p, inactive, filter);
  }

  static constexpr bool may_wake = has_bodies && contains<typename effects_type::inactive_reads, slow_steps>;

  /// True of a particle that sleeps where a body that moves may touch it.
  template <class Skipping>
  COLLIDE_HD_INLINE bool is_woken(Skipping const& p, std::size_t i) const {
    if (!context.effects.only_sleeps(p)) return false;
    S const* const x = context.state.at(position{}) + 3 * i;
    sphere<S> const here{{x[0], x[1], x[2]}, context.state.radius_at(i)};
    if constexpr (is_swept) {
      return !context.triangles.opened().misses_moving_bodies(moving_sphere<S>{here, {S(0), S(0), S(0)}});
    } else {
      return !context.triangles.opened().misses_moving_bodies(here);
    }
  }

  /// A particle that sleeps presses on what it lies on.
  COLLIDE_HD_INLINE void press(std::size_t i) const {
    integrated p;
    context.state.load(p, i);
    record_sleeping(context, p,
                    first_kick<Context>(p) + (effects_type::ends_after_meeting ? S(0) : last_kick<Context>(p)));
    context.state.store(p, i, typename effects_type::integration_writes{});
  }

  template <class Block, class P, int N>
  COLLIDE_HD_INLINE void load(Block& block, scratch<Block>& s, P (&p)[N], std::size_t first) const {
    for (int k = 0; k < N; k += pack) context.state.load_pack(block, s, p + k, first + static_cast<std::size_t>(k));
  }

  /// The test for particles of one radius in one grid of one level: without branches, for the CPU's vector unit, as
  /// which particles are near the mesh is not to be foreseen. False if it is not known: one of them goes a long way.
  template <int N>
  COLLIDE_HD_INLINE bool test_occupied(occupancy_view<S> const& occupancy, integrated const (&p)[N],
                                       bool (&near)[N]) const {
    moving_pack<S, N> batch;
    for (int k = 0; k < N; ++k) {
      vec3<S> const& c = p[k][position{}];
      batch.x[k] = c.x(), batch.y[k] = c.y(), batch.z[k] = c.z();
      if constexpr (is_swept) {
        vec3<S> const d = p[k][velocity{}] * context.dt;
        batch.dx[k] = d.x(), batch.dy[k] = d.y(), batch.dz[k] = d.z();
      }
    }
    if constexpr (has_bodies) {
      return !is_swept &&
             context.triangles.test_occupied(occupancy, batch.x, batch.y, batch.z, context.state.common_radius, near);
    } else if constexpr (is_swept) {
      return occupancy.test_swept(batch, near);
    } else {
      occupancy.test_occupied(occupancy.places_of(batch.x, batch.y, batch.z), near);
      return true;
    }
  }

  /// In any grids. The long code goes round: what it indexes is not in registers, so they are copies.
  template <int N>
  COLLIDE_HD_INLINE void test_each(integrated const (&p)[N], bool (&near)[N]) const {
    triangles_type const triangles = context.triangles.opened();
    decltype(shape_of(p[0])) shapes[N];
    for (int k = 0; k < N; ++k) shapes[k] = shape_of(p[k]);
    std::uint32_t const found = near_triangles(triangles, shapes);
    for (int k = 0; k < N; ++k) near[k] = (found >> k & 1) != 0;
  }

  /// The sphere as the narrow phase takes it.
  COLLIDE_HD_INLINE auto shape_of(integrated const& p) const {
    if constexpr (is_swept) {
      S const radius = p.the_radius >= 0 ? max(p.the_radius, context.min_radius) : p.the_radius;
      return moving_sphere<S>{{p[position{}], radius}, p[velocity{}] * context.dt};
    } else {
      return sphere<S>{p[position{}], p.the_radius};
    }
  }
};

}  // namespace collide::detail

#pragma GCC diagnostic pop
