/// \file
/// What a simulation does on the host with effects and columns.
#pragma once

#include <algorithm>

#include <collide/detail/simulation/effect_list.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

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
