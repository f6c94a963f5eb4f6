/// \file
/// Kernel bodies for what is done with particles besides a step.
#pragma once

#include <cstddef>

#include <collide/effects/detail/particle.hpp>
#include <collide/simulation/detail/step/integrate.hpp>
#include <collide/simulation/detail/step/mesh_contact.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// Kernel functor of `for_each` over places of particles: what each begins with.
template <class S, class All>
struct init_particles {
  particle_state<S, All> state;
  sphere_view<S> spheres;
  S const* velocities;  ///< null: they rest
  S source_radius;      ///< of what a source makes; 0: the common one

  COLLIDE_HD void operator()(std::size_t i) const {
    particle<S, All> p;
    set_initial_values(p);
    bool const there = i < spheres.size();
    if (there) {
      p[position{}] = spheres.centre(i);
      if (velocities != nullptr) {
        p[velocity{}] = vec3<S>(velocities[3 * i], velocities[3 * i + 1], velocities[3 * i + 2]);
      }
    }
    if constexpr (contains<All, radius>)
      p[radius{}] = there ? spheres.radius(i) : source_radius > 0 ? source_radius : spheres.common_radius();
    if constexpr (contains<All, alive>) p[alive{}] = there;
    state.store(p, i, All{});
  }
};

/// Kernel functor of `for_each` over particles: what an effect has just made at a place that was free begins with the
/// initial values of the columns `Initial`, which that effect does not write, and has touched nothing.
template <class S, class Effects, class Initial>
struct begin_anew {
  particle_state<S, typename Effects::all> state;
  std::uint8_t const* was_there;  ///< `alive` before
  std::uint8_t* surfaces;         ///< how many each remembers; null if none does

  COLLIDE_HD void operator()(std::size_t i) const {
    std::uint8_t& mark = state.at(alive{})[i];
    if (mark == 1 && was_there[i] == made_by_effect) mark = made_by_effect;  // by one before
    if (was_there[i] != 0 || mark != 1) return;
    particle<S, Initial> p;
    set_initial_values(p);
    state.store(p, i, Initial{});
    if (surfaces != nullptr) surfaces[i] = 0;
    if constexpr (Effects::any_pair_contact && Effects::remembered::size != 0) mark = made_by_effect;
  }
};

/// Kernel functor of `for_each` over particles: takes off the marks of `begin_anew`.
struct take_marks_off {
  std::uint8_t* marks;
  COLLIDE_HD void operator()(std::size_t i) const {
    if (marks[i] == made_by_effect) marks[i] = 1;
  }
};

/// Kernel functor of `for_each` over particles: wakes them where a source has just taken places from others.
template <class State>
struct wake_where_others_went {
  State state;

  COLLIDE_HD void operator()(std::size_t i) const {
    double capacity = static_cast<double>(state.size - state.placed);
    if constexpr (contains<typename State::list, global_number>)
      capacity = static_cast<double>(state.all_size - state.all_placed);
    if (state.time[clock_made_now] == 0 || capacity <= 0) return;
    if (state.time[clock_made] > capacity) state.at(slow_steps{})[i] = 0;
  }
};

/// Kernel functor of `for_each` over particles: wakes those that sleep, between steps. Forces on them are not known, or
/// not those of the mesh where others' are passed on to what they lie on.
template <class S, class Effects>
struct wake_between_steps {
  particle_state<S, typename Effects::all> state;
  Effects effects;

  COLLIDE_HD void operator()(std::size_t i) const {
    particle<S, union_of<typename Effects::inactive_reads, typename Effects::interaction_kicks>> p;
    state.load(p, i);
    if (effects.is_inactive(p) && effects.only_sleeps(p)) {
      state.at(in_contact{})[i] = just_woken;
      if constexpr (!Effects::keeps_support) {
        set_initial_values(p);
        state.store(p, i, typename Effects::interaction_kicks{});
      }
    }
    state.at(slow_steps{})[i] = 0;
  }
};

/// Kernel functor of `for_each` over particles: ends their step, where particles have met in between.
template <class S, class Effects>
struct end_particles {
  using scalar = S;
  using effects_type = Effects;
  static constexpr S kick_after = S(Effects::integrator::kick_after);

  particle_state<S, typename Effects::all> state;
  Effects effects;
  S dt;

  COLLIDE_HD void operator()(std::size_t i) const {
    particle<S, typename Effects::integration_reads> p;
    state.load(p, i);
    if constexpr (Effects::any_inactive) {
      if (effects.is_inactive(p)) {
        if constexpr (Effects::keeps_support) press(p);
        return;
      }
    }
    end_particle(*this, p);
    state.store(p, i, typename Effects::integration_writes{});
  }

 private:
  template <class Particle>
  COLLIDE_HD_INLINE void press(Particle& p) const {
    if (!effects.only_sleeps(p)) return;
    record_sleeping(*this, p, last_kick<end_particles>(p));
    state.store(p, p.number, typename Effects::integration_writes{});
  }
};

/// Kernel functor of `for_each` over particles: frees those that stick to the mesh where it no longer is.
template <class State, class Triangles>
struct release_stuck {
  State state;
  Triangles triangles;
  bool are_driven;  ///< bodies, which are not where they will be
  std::size_t bodies;

  COLLIDE_HD void operator()(std::size_t i) const {
    std::uint8_t& stuck = state.at(adhered{})[i];
    if (are_driven && is_stuck(stuck) && std::size_t{stuck} > bodies + 1) stuck = 0;  // there is no such body any more
    if (stuck == 0 || (are_driven && stuck > 1)) return;
    auto const* const x = state.at(position{}) + 3 * i;
    using S = std::decay_t<decltype(*x)>;
    vec3<S> const centre(x[0], x[1], x[2]);
    S const r = state.radius_at(i);
    std::uint8_t const found = find(sphere<S>{centre, r + 2 * (contact_tolerance<S> * r + rounding_at(centre))});
    if (stuck != came_too_fast || found == 0) stuck = found;
  }

 private:
  /// The part of the mesh that a sphere touches, as `adhered` has it: of several triangles the first in memory.
  template <class S>
  COLLIDE_HD std::uint8_t find(sphere<S> const& s) const {
    Triangles const near = triangles.opened();
    id first = no_id;
    auto cursor = near.begin(s);
    candidate_range range{};
    while (next_range(near, s, cursor, range)) {
      for (std::uint32_t k = 0; k < range.count; ++k) {
        cell_item const e = range.at(k);
        if (e.triangle < first && touches(near, s, e.triangle)) first = e.triangle;
      }
    }
    return first == no_id ? std::uint8_t{0} : static_cast<std::uint8_t>(frame_in(near, first) + 1);
  }
  template <class S>
  COLLIDE_HD bool touches(Triangles const& near, sphere<S> const& s, id triangle) const {
    int const frame = frame_in(near, triangle);
    if (are_driven && frame != 0) return false;
    return contact_double(near.mesh[triangle], seen_from(near, frame, s)).depth >= 0;
  }
};

template <class S, class All, class Effects>
init_particles<S, All> initial(particle_state<S, All> const& state, sphere_view<S> const& spheres, S const* velocities,
                               Effects const& effects) {
  return {state, spheres, velocities, effects.source_radius()};
}

/// Kernel functor of `for_each` over one item.
struct advance_time {
  double* time;
  double dt, due;  ///< of a source; see `begin_in_step`
  COLLIDE_HD void operator()(std::size_t) const {
    auto const begun = static_cast<double>(begin_in_step(time, due));
    time[0] += dt;
    time[clock_made] += begun;
    time[clock_fraction] += due - begun;
    time[clock_made_now] = begun;
  }
};

}  // namespace collide::detail
