/// \file
/// Effect: the resistance of a medium at rest.
#pragma once

#include <collide/detail/numeric/rounding.hpp>
#include <collide/effect.hpp>

namespace collide {

/// A medium slows particles down: dv/dt = -(linear + quadratic |v|) v. `linear` is per unit of time, `quadratic` per
/// unit of length. The step is implicit, v / (1 + k dt), so that it is stable however strong the drag is.
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

  template <class Particle, class S>
  COLLIDE_HD_INLINE void accelerate(Particle& p, S dt) const {
    auto& v = p[velocity{}];
    S const k = S(linear) + S(quadratic) * detail::sqrt_rn(detail::dot(v, v));
    v = v * (1 / (1 + k * dt));
  }
};

}  // namespace collide
