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
  using runs_after = effects<bounce>;
  static constexpr bool needs_contacts = true;  ///< with a solid mesh, or between particles

  double rolling_resistance = 0;  ///< a ratio of forces, not negative

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(rolling_resistance),
                            "spin: rolling_resistance is not negative, and finite");
  }

  template <class Particle, class S>
  COLLIDE_HD_INLINE void after_mesh_contact(Particle& p, mesh_contact<S>& t, S) const {
    S most = S(rolling_resistance) * t.normal_impulse;
    if (!(most > 0)) return;
    if (t.friction_reserve > 0) most = slow_rolling(p, t, most);
    auto& w = p[angular_velocity{}];
    S const rate = detail::sqrt_rn(detail::dot(w, w));
    if (rate > 0) w = w * (detail::max(rate - S(2.5) * most / p.radius(), S(0)) / rate);
  }

 private:
  /// What rolls without slipping is slowed down as a whole: friction, as far as it has a reserve, keeps rotation and
  /// motion together. Returns what is left of the resistance `most`, both per mass.
  template <class Particle, class S>
  COLLIDE_HD_INLINE static S slow_rolling(Particle& p, mesh_contact<S>& t, S most) {
    auto& w = p[angular_velocity{}];
    vec3<S> const turning = w - t.normal * detail::dot(w, t.normal);
    vec3<S> const rolled = detail::cross(turning, vec3<S>(t.normal * p.radius()));
    S const speed = detail::sqrt_rn(detail::dot(rolled, rolled)), needed = S(1.4) * speed;
    S const resistance = detail::min(most, S(1.4) * t.friction_reserve);
    if (needed <= resistance) {
      w -= turning;
      if (t.is_resting) {
        t.hold(p);
      } else {
        p[velocity{}] -= rolled;
      }
      return most - needed;
    }
    S const part = resistance / needed;
    w -= turning * part;
    p[velocity{}] -= rolled * part;
    if (t.is_resting) p[position{}] -= rolled * (part * t.elapsed);
    return most - resistance;
  }
};

}  // namespace collide
