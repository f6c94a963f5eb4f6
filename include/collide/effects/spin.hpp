/// \file
/// Effect: particles rotate.
#pragma once

#include <collide/effects/bounce.hpp>

namespace collide {

/// Particles have an angular velocity. `friction` at the mesh and between spheres changes it, as they then act where
/// two touch: what slid begins to roll. `rolling_resistance` is the coefficient of rolling resistance, which stops what
/// rolls: the largest torque that resists, per radius and repelling force.
struct spin {
  using writes = columns<position, velocity, angular_velocity>;
  static constexpr bool needs_contacts = true;  ///< with a solid mesh, or between particles

  double rolling_resistance = 0;  ///< a ratio of forces, not negative

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(rolling_resistance),
                            "spin: rolling_resistance is not negative, and finite");
  }

  template <class Particle, class S>
  COLLIDE_HD_INLINE void after_mesh_contact(Particle& p, mesh_contact<S>& t, S) const {
    S limit = S(rolling_resistance) * t.normal_impulse;
    if (!(limit > 0)) return;
    if (t.friction_reserve > 0) limit = slow_rolling(p, t, limit);
    auto& w = p[angular_velocity{}];
    S const rate = detail::sqrt_rn(detail::dot(w, w));
    if (rate > 0) w = w * (detail::max(rate - S(2.5) * limit / p.radius(), S(0)) / rate);
  }

 private:
  /// A particle that rolls without slipping is slowed down as a whole: friction, as far as it has a reserve, keeps
  /// rotation and motion together. Returns what is left of the resistance `limit`, both per mass.
  template <class Particle, class S>
  COLLIDE_HD_INLINE static S slow_rolling(Particle& p, mesh_contact<S>& t, S limit) {
    auto& w = p[angular_velocity{}];
    vec3<S> const turning = w - t.normal * detail::dot(w, t.normal);
    vec3<S> const rolled = detail::cross(turning, vec3<S>(t.normal * p.radius()));
    S const speed = detail::sqrt_rn(detail::dot(rolled, rolled)), needed = S(1.4) * speed;
    S const resistance = detail::min(limit, S(1.4) * t.friction_reserve);
    if (needed <= resistance) {
      w -= turning;
      if (t.is_resting) {
        t.hold(p);
      } else {
        p[velocity{}] -= rolled;
      }
      return limit - needed;
    }
    S const fraction = resistance / needed;
    w -= turning * fraction;
    p[velocity{}] -= rolled * fraction;
    if (t.is_resting) p[position{}] -= rolled * (fraction * t.elapsed);
    return limit - resistance;
  }
};

}  // namespace collide
