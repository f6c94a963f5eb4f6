/// \file
/// What a simulation does on the host with effects and columns.
#pragma once

#include <algorithm>
#include <limits>

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

/// The radii of a simulation's particles.
template <class S>
struct radius_range {
  S smallest = 0;  ///< of those that are not negative; infinite if there are none
  S largest = 0;
};

/// The radii that particles have in the beginning. Waits if they have radii of their own.
template <class Simulation, class S>
radius_range<S> radius_range_of(Simulation const& simulation, sphere_view<S> const& particles) {
  radius_range<S> found{particles.common_radius(), particles.common_radius()};
  if constexpr (contains<typename Simulation::columns, radius>) {
    if (particles.one_radius()) return found;
    auto const radii = simulation.template to_host<radius>();
    found.smallest = std::numeric_limits<S>::infinity();
    if (!radii.empty()) found.largest = *std::max_element(radii.begin(), radii.end());
    for (S const r : radii) {
      if (r >= 0) found.smallest = smaller(found.smallest, r);
    }
  }
  return found;
}

}  // namespace collide::detail
