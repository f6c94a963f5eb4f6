/// \file
/// Torques that resist rolling.
#pragma once

#include <collide/effects/granular/law.hpp>

namespace collide {

/// The torque of the spring that resists rolling.
struct rolling_torque : detail::vector_column {};

/// A torque of constant size against what turns, model A of J. Ai, J.-F. Chen, J. M. Rotter and J. Y. Ooi, Powder
/// Technology 206, 2011: rolling friction times R* times the elastic force, without what cohesion takes from it. What
/// is nearly at rest trembles. Twist, which is turning about the normal, does not change it; LIGGGHTS' `cdt` divides by
/// the rate of rolling and twist together, so that what twists rolls more easily there.
struct constant_torque {
  static constexpr bool is_mutual = true;  ///< see law.hpp
  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> torque(granular_pair<S> const& p, detail::contact_material const& m,
                                   normal_force<S> const& n, Memory const&) const {
    S const rate = detail::length_of(p.turning);
    S const force = detail::max(S(n.elastic + 2 * n.pull_off), S(0));
    return detail::either(rate > 0, vec3<S>(p.turning * (-S(m.rolling_friction) * p.radius * force / rate)),
                          vec3<S>(S(0), S(0), S(0)));
  }
};

namespace detail {

/// Turns a spring that resists rolling into the plane of contact, and about the normal if it is to, winds it up, and
/// cuts it to its limit, rolling friction times R* times the normal force. True if it was longer.
template <class S>
COLLIDE_HD_INLINE mask_of<S> wind_up(vec3<S>& spring, granular_pair<S> const& p, contact_material const& m,
                                     normal_force<S> const& n, S stiffness, S elapsed, bool turns_about_normal) {
  spring -= p.normal * dot(spring, p.normal);
  if (turns_about_normal) turn_about_normal(spring, p, elapsed);
  spring -= p.turning * (stiffness * elapsed);
  S const limit = S(m.rolling_friction) * p.radius * n.holding(p), length = length_of(spring);
  mask_of<S> const was_longer = length > limit;
  spring = either(was_longer, vec3<S>(spring * (limit / length)), spring);
  return was_longer;
}

}  // namespace detail

/// A spring and dashpot against rolling, up to rolling friction times R* times the normal force: EPSD, model C of J.
/// Ai, J.-F. Chen, J. M. Rotter and J. Y. Ooi, Powder Technology 206, 2011; `epsd` of LIGGGHTS. The stiffness is 2.25
/// k_n (mu_r R*)^2, with k_n the secant of the normal law. So piles stand still.
struct epsd {
  static constexpr bool is_mutual = true;  ///< see law.hpp
  using remembers = contact_columns<rolling_torque>;

  double damping = 0.3;             ///< ratio to critical damping, not negative
  bool turns_about_normal = false;  ///< the spring turns with the spins of the two about the normal, too

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(damping), "epsd: damping is not negative, and finite");
  }
  template <class F>
  void for_each_part(F const& f) {
    f(damping);
    f(turns_about_normal);
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> torque(granular_pair<S> const& p, detail::contact_material const& m,
                                   normal_force<S> const& n, Memory const& memory) const {
    S const arm = S(m.rolling_friction) * p.radius;
    S const stiffness = S(2.25) * n.secant * arm * arm;
    vec3<S>& spring = memory[rolling_torque{}];
    auto const was_longer = detail::wind_up(spring, p, m, n, stiffness, memory.elapsed(), turns_about_normal);
    vec3<S> const damped = spring - p.turning * (S(2 * damping) * detail::sqrt_rn(p.rolling_inertia * stiffness));
    return detail::either(was_longer, spring, damped);
  }
};

/// `epsd` without the dashpot, and of stiffness k_t R*^2, with k_t = 8 G* a that of `mindlin`: EPSD2 of LIGGGHTS, after
/// K. Iwashita and M. Oda, Journal of Engineering Mechanics 124, 1998.
struct epsd2 {
  static constexpr bool is_mutual = true;  ///< see law.hpp
  using remembers = contact_columns<rolling_torque>;
  static constexpr bool needs_hertz = true;  ///< the normal law must be `hertz`

  bool turns_about_normal = false;  ///< the spring turns with the spins of the two about the normal, too

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> torque(granular_pair<S> const& p, detail::contact_material const& m,
                                   normal_force<S> const& n, Memory const& memory) const {
    vec3<S>& spring = memory[rolling_torque{}];
    detail::wind_up(spring, p, m, n, S(8 * m.shear) * n.contact_radius * p.radius * p.radius, memory.elapsed(),
                    turns_about_normal);
    return spring;
  }
};

}  // namespace collide
