/// \file
/// An effect of our own, for what is wet: spheres that touch hold on to each other.
#pragma once

#include <collide/effects/effect.hpp>

namespace io {

/// Spheres that overlap attract each other: it takes an acceleration of more than `pull` to part them. All are of one
/// mass, so that momentum is conserved.
struct cohesion {
  using reads = collide::columns<collide::position>;
  using writes = collide::columns<collide::velocity>;

  double pull = 0;

  template <class Particle, class Seen, class S>
  COLLIDE_HD_INLINE void on_pair_contact(Particle& p, Seen const& self, Seen const& other, S dt) const {
    collide::vec3<S> const towards = other[collide::position{}] - self[collide::position{}];
    S const distance = towards.norm();
    if (distance > 0) p[collide::velocity{}] += towards * (S(pull) * dt / distance);
  }
};

}  // namespace io
