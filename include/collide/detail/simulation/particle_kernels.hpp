/// \file
/// Kernel bodies for what is done with particles besides a step.
#pragma once

#include <cstddef>

#include <collide/detail/simulation/particle.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// Kernel body of `for_each` over places of particles: what each begins with.
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

template <class S, class All, class Effects>
init_particles<S, All> initial(particle_state<S, All> const& state, sphere_view<S> const& spheres, S const* velocities,
                               Effects const& effects) {
  return {state, spheres, velocities, effects.source_radius()};
}

/// Kernel body of `for_each`.
template <class T>
struct copy_values {
  T const* from;
  T* to;
  COLLIDE_HD void operator()(std::size_t i) const { to[i] = from[i]; }
};

/// Kernel body of `for_each` over one item.
struct advance_time {
  double* time;
  double dt, due;  ///< of a source; see `begin_in_step`
  COLLIDE_HD void operator()(std::size_t) const {
    auto const begun = static_cast<double>(begin_in_step(time, due));
    time[0] += dt;
    time[1] += begun;
    time[2] += due - begun;
  }
};

}  // namespace collide::detail
