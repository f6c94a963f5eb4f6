/// \file
/// Effect: Coulomb friction at the mesh.
#pragma once

#include <collide/bounce.hpp>

namespace collide {

/// Coulomb friction at the mesh: what slides is slowed down by at most `kinetic` times what `bounce` repels it with;
/// what could be stopped by at most `statical` times that, is stopped. With `spin` in the scene it acts where the
/// particle touches, and makes it roll: a solid sphere, of moment of inertia 2/5 m R^2.
struct friction {
  using writes = columns<position, velocity>;
  using shares = columns<angular_velocity>;
  using follows = effects<bounce>;

  double statical = 0.5, kinetic = 0.5;

  template <class Particle, class S>
  COLLIDE_HD_INLINE void touch(Particle& p, touching<S>& t, S) const {
    constexpr bool spins = Particle::template has<angular_velocity>;
    if (!(t.impulse > 0)) return;
    vec3<S> slip = p[velocity{}];
    if constexpr (spins) slip -= detail::cross(p[angular_velocity{}], vec3<S>(t.normal * p.radius()));
    slip -= t.normal * detail::dot(slip, t.normal);
    S const speed = detail::root(detail::dot(slip, slip));
    S const needed = spins ? speed * S(2.0 / 7) : speed, most = S(statical) * t.impulse;
    if (needed <= most) t.grip = most - needed;
    if (!spins && t.rests && needed <= most) return t.hold(p);
    if (!(needed > 0)) return;
    S const applied = needed <= most ? needed : detail::smaller(needed, S(kinetic) * t.impulse);
    vec3<S> const change = slip * (applied / speed);
    p[velocity{}] -= change;
    if (t.rests) p[position{}] -= change * t.moved;  // it acted all the time, not only now
    if constexpr (spins) {
      if (p.radius() > 0) p[angular_velocity{}] += detail::cross(t.normal, change) * (S(2.5) / p.radius());
    }
  }
};

}  // namespace collide
