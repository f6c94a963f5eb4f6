/// \file
/// Normal force of a linear spring and dashpot.
#pragma once

#include <collide/effects/granular/law.hpp>

namespace collide {

/// A spring of constant stiffness, with the dashpot that gives the coefficient of restitution at any speed: P. A.
/// Cundall and O. D. L. Strack, "A discrete numerical model for granular assemblies", Geotechnique 29(1), 1979; damping
/// 2 beta sqrt(k m*).
struct linear {
  static constexpr bool is_mutual = true;      ///< see law.hpp
  static constexpr bool is_hertzian = false;   ///< the two touch as Hertz says
  static constexpr double damping_factor = 2;  ///< of beta sqrt(stiffness m*)

  double stiffness = 1000;  ///< force per overlap, above 0

  /// The spring of a time of contact: m* (pi^2 + ln^2 e) / time^2, of spheres of the effective mass `mass` that rebound
  /// with `restitution`. All are above 0.
  static linear of_contact_time(double time, double restitution, double mass) {
    double const log_e = std::log(restitution);
    return {mass * (9.869604401089358 + log_e * log_e) / (time * time)};
  }

  void check_parameters() const {
    detail::check_parameter(detail::is_positive(stiffness), "linear: stiffness is above 0, and finite");
  }

  template <class S>
  COLLIDE_HD_INLINE normal_force<S> force(granular_pair<S> const& p, detail::contact_material const&) const {
    S const k = S(stiffness), overlap = detail::max(p.overlap, S(0));
    return {k * overlap, k, detail::sqrt_rn(p.radius * overlap)};
  }
};

}  // namespace collide
