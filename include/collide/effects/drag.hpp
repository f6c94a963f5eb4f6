/// \file
/// Effect: the resistance of a medium at rest.
#pragma once

#include <collide/effects/detail/resistance.hpp>
#include <collide/effects/effect.hpp>

namespace collide {

/// A medium slows particles down: dv/dt = a - (linear + quadratic |v|) v, where a is what `accelerate` of all other
/// effects does, wherever they are in the list. `linear` is per unit of time, `quadratic` per unit of length. However
/// strong it is, a step is exact if the drag is linear, or v and a are parallel, so that what falls gets the terminal
/// velocity; else it is of second order, and never faster than both the velocity before and the terminal one.
///
/// What rests on a mesh by `bounce` is slowed as if it fell for each step: `reaction` and `mesh_forces` get
/// 1 - `linear` dt / 2 of its weight, to first order.
///
/// For a sphere of radius R and density D in a medium of density d and viscosity m, linear = 9 m / (2 D R^2) (Stokes),
/// and quadratic = 3 C d / (8 D R) with the drag coefficient C, about 0.5.
struct drag {
  using writes = columns<velocity>;

  double linear = 0;     ///< per time, not negative
  double quadratic = 0;  ///< per length, not negative

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(linear) && detail::is_amount(quadratic),
                            "drag: linear and quadratic are not negative, and finite");
  }

  template <class Particle>
  COLLIDE_HD_INLINE detail::medium_at_rest resistance(Particle const&) const {
    return {{linear, quadratic, {0, 0, 0}}};
  }
};

}  // namespace collide
