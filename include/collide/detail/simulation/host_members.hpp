/// \file
/// What a simulation does on the host with effects and columns.
#pragma once

#include <algorithm>
#include <cstdint>

#include <collide/detail/simulation/effect_list.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// Throws `error` if these are more places than a simulation may have.
inline void check_places(std::uint64_t places) {
  if (places >= no_id) throw error("collide: simulation: a simulation has at most 2^32 - 2 particles");
}

/// Throws `error` unless a simulation with these columns can have such particles, and places for them.
template <class Columns>
void check_particles(bool one_radius, std::uint64_t particles, std::uint64_t places) {
  if (!one_radius && !contains<Columns, radius>) {
    throw error("collide: simulation: the radii differ: name the effect polydisperse in the scene");
  }
  if (places > particles && !contains<Columns, alive>) {
    throw error("collide: simulation: there is room for more particles, but no effect in the scene that makes any");
  }
  check_places(places);
}

/// Calls an effect's `check_parameters`, if it has one.
template <class E, class Effects>
void check_parameters_of(Effects const& effects) {
  if constexpr (checks_parameters<E>::value) effects.template of<E>().check_parameters();
}

/// Calls an effect's `begin_step`, if it has one.
template <class E, class Effects, class Space, class State, class S>
void begin_step_of(Effects& effects, Space& space, State const& state, S dt) {
  if constexpr (begins_in<E, Space, State, S>::value) effects.template of<E>().begin_step(space, state, dt);
}

/// The largest radius of a simulation's particles. Waits if they have radii of their own.
template <class Simulation, class S>
S largest_radius_of(Simulation const& simulation, sphere_view<S> const& particles) {
  if constexpr (contains<typename Simulation::columns, radius>) {
    if (!particles.one_radius()) {
      auto const radii = simulation.template to_host<radius>();
      return radii.empty() ? S(0) : *std::max_element(radii.begin(), radii.end());
    }
  }
  return particles.common_radius();
}

}  // namespace collide::detail
