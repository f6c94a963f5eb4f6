/// \file
/// Effect: forces that another program computes, such as a solver of the fluid around the particles.
#pragma once

#include <collide/effects/detail/column_list.hpp>
#include <collide/effects/effect.hpp>
#include <collide/effects/granular/materials.hpp>

namespace collide {

/// Force on a particle in mass times length per time squared, which someone else writes between steps; 0 to begin with.
/// See `external_forces`.
struct external_force : detail::vector_column {};

/// Accelerates each particle by its `external_force` over its mass. The force is the same all through a step; between
/// steps a solver writes it: `assign<external_force>(values)`, or a kernel on the space's stream to
/// `data<external_force>()`. Like `gravity` it is in `mesh_forces` and `reaction` where the mesh holds against it. It
/// wakes what sleeps if it comes by `assign`, not if by `data`. What has a radius of 0 has no mass, and
/// no force moves it. 3 scalars a particle.
///
/// \tparam Materials  whose masses: `one_density`, or that of `granular_contact`
template <class Materials = one_density>
struct external_forces {
  using reads = detail::union_of<columns<external_force>, typename Materials::reads>;
  using optional_reads = columns<radius>;
  using writes = columns<velocity>;
  static constexpr bool saves_parameters = detail::saves_parameters<Materials>;

  Materials made_of{};  ///< densities

  void check_parameters() const { made_of.check_parameters(); }

  template <class Particle, class S>
  COLLIDE_HD_INLINE void accelerate(Particle& p, S dt) const {
    S const mass = detail::sphere_mass(S(1), p.radius()) * made_of.template density_of<S>(p);
    if (mass > 0) p[velocity{}] += p[external_force{}] * (dt / mass);
  }
};

}  // namespace collide
