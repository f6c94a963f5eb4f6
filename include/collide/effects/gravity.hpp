/// \file
/// Effect: a constant acceleration.
#pragma once

#include <collide/effects/effect.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>

namespace collide {

/// A constant acceleration, in units of length per unit of time squared.
struct gravity {
  using writes = columns<velocity>;

  double x = 0;      ///< length per time squared, finite
  double y = 0;      ///< length per time squared, finite
  double z = -9.81;  ///< length per time squared, finite: that of the earth in metres and seconds

  void check_parameters() const {
    detail::check_parameter(detail::is_finite(x) && detail::is_finite(y) && detail::is_finite(z),
                            "gravity: the acceleration is finite");
  }

  template <class Particle, class S>
  COLLIDE_HD_INLINE void accelerate(Particle& p, S dt) const {
    p[velocity{}] += vec3<S>(S(x), S(y), S(z)) * dt;
  }
};

}  // namespace collide
