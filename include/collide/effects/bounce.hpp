/// \file
/// Effect: the mesh is solid.
#pragma once

#include <collide/effects/effect.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide {

/// The mesh repels: the velocity along the normal turns around, times `restitution` (1: elastic, 0: not at all), and
/// the particle is put back to the surface. A particle that would leave it by no more than three times a step's
/// acceleration, and so be back within six steps, rests on the surface: in a groove, what has slid down one wall for a
/// step meets the other one so fast.
///
/// The velocity is turned around as it is at the impact, not as it is in the middle of the step, and what is left of
/// the step is spent on the way back: so under a constant force elastic bounces keep their height to rounding, whatever
/// the step, with both integrators.
struct bounce {
  using writes = columns<position, velocity>;
  static constexpr bool repels = true;  ///< the mesh is solid

  double restitution = 0.5;  ///< speed after a bounce over speed before it, 0 to 1

  void check_parameters() const {
    detail::check_parameter(restitution >= 0 && restitution <= 1, "bounce: restitution is from 0 to 1");
  }

  template <class Particle, class S>
  COLLIDE_HD_INLINE void on_mesh_contact(Particle& p, mesh_contact<S>& t, S dt) const {
    S const e = S(restitution), speed = -detail::dot(p[velocity{}], t.normal);
    S back = detail::max(t.depth, S(0));
    if (speed > 0) {
      S const rebound = e * detail::max(detail::min(t.approach_speed, speed), S(0));
      S const a = detail::dot(t.force_dv, t.normal), late = detail::min(back / speed, dt);
      t.is_resting = rebound <= 3 * -a;
      S const leaves = t.is_resting ? S(0) : leaving_speed(e, rebound, a, (t.remaining + late) / dt);
      t.repel(p[velocity{}], speed + leaves);
      back += leaves * late;
    }
    t.push_out(p[position{}], back);
  }

 private:
  /// How fast a particle leaves that has come with `rebound` / e. Speeds are those in the middle of a step, of which
  /// the part `left` comes after the impact, and a is what acceleration adds in a step. If x is where the step ends,
  /// both integrators keep (v + a / 2)^2 / 2 - a x / dt: the speed at the wall is that of x = 0, it is e times as
  /// large after the impact, and with the one that leaves x is left * dt times it.
  template <class S>
  COLLIDE_HD_INLINE static S leaving_speed(S e, S rebound, S a, S left) {
    if (a == 0 || !(rebound > 0)) return rebound;
    S const push = a * (1 - 2 * left), hit = 4 * rebound * (rebound - e * push) + e * e * a * a;
    return detail::max((detail::sqrt_rn(detail::max(hit + push * push - a * a, S(0))) - push) / 2, S(0));
  }
};

}  // namespace collide
