/// \file
/// Effects: the forces of contacts on each particle, as columns.
#pragma once

#include <collide/effects/effect.hpp>

namespace collide {

struct bounce;
struct friction;
struct spin;
struct adhesion;

/// Force of the mesh on a particle, in mass times length per time squared; see `mesh_forces`.
struct mesh_force : detail::vector_column {};

/// Force of other particles on a particle, in mass times length per time squared; see `pair_forces`.
struct pair_force : detail::vector_column {};

namespace detail {

/// Mass over dt: force for a change of velocity in a step.
template <class S>
COLLIDE_HD_INLINE S force_per_change(double density, S radius, S dt) {
  return dt > 0 ? sphere_mass(density, radius) / dt : S(0);
}

}  // namespace detail

/// Sums the forces with which the mesh acts on each particle in a step: mass times what its contacts change of the
/// velocity, over dt. So it is the mean over the step, of an impact as of what rests: that is pressed by its weight.
/// It includes what `adhesion` holds, and the pressure of particles that sleep, with all that would accelerate them.
/// `to_host<mesh_force>()` reads it after a step, `data<mesh_force>()` is where it is. Its place in the list
/// does not matter. 3 scalars a particle.
struct mesh_forces {
  using writes = columns<mesh_force>;
  static constexpr bool begins_on_ranks = true;  ///< `begin_step` does its work whatever rank a particle is on

  double density = 1;  ///< mass per volume, above 0: a particle has the mass of a solid sphere

  void check_parameters() const {
    detail::check_parameter(detail::is_positive(density), "mesh_forces: density is above 0, and finite");
  }

  template <class Space, class State, class S>
  void begin_step(Space& space, State const& state, S) const {
    space.fill(state.at(mesh_force{}), 0, 3 * state.size * sizeof(S));
  }
  template <class Particle, class S>
  COLLIDE_HD_INLINE void on_mesh_impulse(Particle& p, mesh_impulse<S> const& t, S dt) const {
    p[mesh_force{}] += t.change * detail::force_per_change(density, p.radius(), dt);
  }
};

/// Sums the forces with which other particles act on each particle in a step: mass times what `sphere_contact`,
/// `granular_contact` or an effect of your own with `on_pair_contact` changes of the velocity, over dt. 0 for particles
/// that `sleep`. `to_host<pair_force>()` reads it after a step. In a list it comes behind all of these, else it does
/// not compile. 3 scalars a particle, and as many in the lists of neighbours, which a scene has with it if it had none.
struct pair_forces {
  using reads = columns<velocity>;
  using writes = columns<pair_force>;
  static constexpr bool follows_pair_contacts = true;  ///< in a list it comes behind what acts between particles
  static constexpr bool begins_on_ranks = true;        ///< `begin_step` does its work whatever rank a particle is on

  double density = 1;  ///< mass per volume, above 0: that of `sphere_contact`

  void check_parameters() const {
    detail::check_parameter(detail::is_positive(density), "pair_forces: density is above 0, and finite");
  }

  template <class Space, class State, class S>
  void begin_step(Space& space, State const& state, S) const {
    space.fill(state.at(pair_force{}), 0, 3 * state.size * sizeof(S));
  }
  template <class Particle, class Seen, class S>
  COLLIDE_HD_INLINE void on_pair_contact(Particle& p, Seen const& self, Seen const&, S dt) const {
    vec3<S> const change = p[velocity{}] - self[velocity{}];  // by all others that it has met so far
    p[pair_force{}] = change * detail::force_per_change(density, p.radius(), dt);
  }
};

}  // namespace collide
