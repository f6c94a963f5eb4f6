/// \file
/// Effect: particles rotate.
#pragma once

#include <collide/bounce.hpp>

namespace collide {

/// Particles have an angular velocity. `friction` at the mesh and between spheres changes it, as they then act where
/// two touch: what slid begins to roll. `rolling` is the coefficient of rolling resistance, which stops what rolls: the
/// largest torque that resists, per radius and repelling force.
struct spin {
  using writes = columns<angular_velocity>;
  using follows = effects<bounce>;

  double rolling = 0;

  template <class Particle, class S>
  COLLIDE_HD_INLINE void touch(Particle& p, touching<S>& t, S) const {
    auto& w = p[angular_velocity{}];
    S const rate = detail::root(detail::dot(w, w)), most = S(2.5) * S(rolling) * t.impulse;
    if (!(rate > 0 && most > 0)) return;
    w = w * (detail::larger(rate - most / p.radius(), S(0)) / rate);
  }
};

}  // namespace collide
