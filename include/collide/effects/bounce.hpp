/// \file
/// Effect: the mesh is solid.
#pragma once

#include <collide/detail/numeric/rounding.hpp>
#include <collide/effect.hpp>

namespace collide {

/// The mesh repels: the velocity along the normal turns around, times `restitution` (1: elastic, 0: not at all), and
/// the particle is put back to the surface. A particle that would leave it by no more than three times a step's
/// acceleration, and so be back within six steps, rests on the surface: in a groove, what has slid down one wall for a
/// step meets the other one so fast.
///
/// The rest of the step after the impact, depth / speed, is spent on the way back, so that bounces lose or gain
/// no height on average, whatever the step.
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
      t.is_resting = rebound <= 3 * -detail::dot(t.force_dv, t.normal);
      t.repel(p[velocity{}], t.is_resting ? speed : speed + rebound);
      if (!t.is_resting) back += rebound * detail::min(back / speed, dt);
    }
    t.push_out(p[position{}], back);
  }
};

}  // namespace collide
