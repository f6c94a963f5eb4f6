/// \file
/// Effect: Coulomb friction at the mesh.
#pragma once

#include <collide/effects/bounce.hpp>

namespace collide {

/// Coulomb friction at the mesh: the impulse that stops sliding, if that is at most `static_coefficient` times the
/// normal impulse of `bounce`; otherwise `kinetic_coefficient` times it. With `spin` in the scene it acts where the
/// particle touches, and makes it roll: a solid sphere, of moment of inertia 2/5 m R^2.
struct friction {
  using writes = columns<position, velocity>;
  using optional_writes = columns<angular_velocity>;
  static constexpr bool needs_solid_mesh = true;  ///< an effect that `repels` is before it, such as `bounce`

  double static_coefficient = 0.5;   ///< of what rests: a ratio of forces, not negative
  double kinetic_coefficient = 0.5;  ///< of what slides: not negative, nor above that of what rests

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(static_coefficient) && detail::is_amount(kinetic_coefficient),
                            "friction: coefficients are not negative, and finite");
    detail::check_parameter(kinetic_coefficient <= static_coefficient,
                            "friction: kinetic_coefficient is not above static_coefficient");
  }

  template <class Particle, class S>
  COLLIDE_HD_INLINE void on_mesh_contact(Particle& p, mesh_contact<S>& t, S) const {
    constexpr bool spins = Particle::template has<angular_velocity>;
    if (!(t.normal_impulse > 0)) return;
    vec3<S> slip = p[velocity{}];
    if constexpr (spins) slip -= detail::cross(p[angular_velocity{}], vec3<S>(t.normal * p.radius()));
    slip -= t.normal * detail::dot(slip, t.normal);
    S const speed = detail::sqrt_rn(detail::dot(slip, slip));
    S const needed = spins ? speed * S(2.0 / 7) : speed, limit = S(static_coefficient) * t.normal_impulse;
    if (needed <= limit) t.friction_reserve = limit - needed;
    if (!spins && t.is_resting && needed <= limit) return t.hold(p);
    if (!(needed > 0)) return;
    S const applied = needed <= limit ? needed : detail::min(needed, S(kinetic_coefficient) * t.normal_impulse);
    vec3<S> const change = slip * (applied / speed);
    p[velocity{}] -= change;
    if (t.is_resting) p[position{}] -= change * t.elapsed;  // it acted all the time, not only now
    if constexpr (spins) {
      if (p.radius() > 0) p[angular_velocity{}] += detail::cross(t.normal, change) * (S(2.5) / p.radius());
    }
  }
};

}  // namespace collide
