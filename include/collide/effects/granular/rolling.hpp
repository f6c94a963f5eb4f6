/// \file
/// Torques that resist rolling.
#pragma once

#include <collide/effects/granular/law.hpp>

namespace collide {

/// The torque of the spring that resists rolling.
struct rolling_torque {
  template <class S>
  using value = vec3<S>;
};

/// A torque of constant size against what turns, model A of J. Ai, J.-F. Chen, J. M. Rotter and J. Y. Ooi, Powder
/// Technology 206, 2011: rolling friction times R* times the elastic force. What is nearly at rest trembles.
struct constant_torque {
  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> torque(granular_pair<S> const& p, detail::contact_material const& m,
                                   normal_force<S> const& n, Memory const&) const {
    S const rate = detail::length_of(p.turning);
    if (!(rate > 0)) return {S(0), S(0), S(0)};
    return p.turning * (-S(m.rolling_friction) * p.radius * detail::max(n.elastic, S(0)) / rate);
  }
};

/// A spring and dashpot against rolling, up to rolling friction times R* times the normal force: EPSD, model C of J.
/// Ai, J.-F. Chen, J. M. Rotter and J. Y. Ooi, Powder Technology 206, 2011. The stiffness is 2.25 k_n (mu_r R*)^2, with
/// k_n that of the secant. So piles stand still.
struct epsd {
  using remembers = contact_columns<rolling_torque>;

  double damping = 0.3;  ///< ratio to critical damping, not negative

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(damping), "epsd: damping is not negative, and finite");
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> torque(granular_pair<S> const& p, detail::contact_material const& m,
                                   normal_force<S> const& n, Memory const& memory) const {
    S const arm = S(m.rolling_friction) * p.radius, normal = n.total(p);
    S const secant = p.overlap > 0 ? detail::max(n.elastic, S(0)) / p.overlap : S(0);
    S const stiffness = S(2.25) * secant * arm * arm, limit = arm * (normal < 0 ? -normal : normal);
    vec3<S>& spring = memory[rolling_torque{}];
    spring -= p.normal * detail::dot(spring, p.normal);
    spring -= p.turning * (stiffness * memory.elapsed());
    S const length = detail::length_of(spring);
    if (length > limit) {
      spring = spring * (limit / length);
      return spring;
    }
    return spring - p.turning * (S(2 * damping) * detail::sqrt_rn(p.rolling_inertia * stiffness));
  }
};

}  // namespace collide
