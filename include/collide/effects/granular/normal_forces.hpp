/// \file
/// Normal forces: of elastic spheres, and of a linear spring.
#pragma once

#include <collide/effects/granular/law.hpp>

namespace collide {

/// H. Hertz, "Über die Berührung fester elastischer Körper", 1881: 4/3 E* sqrt(R*) overlap^(3/2). Damping, 2 sqrt(5/6)
/// beta sqrt(2 E* a m*), gives the same coefficient of restitution at any speed: Y. Tsuji, T. Tanaka and T. Ishida,
/// Powder Technology 71, 1992; T. Antypov and J. A. Elliott, EPL 94, 2011. At the end of a contact it may pull.
struct hertz {
  static constexpr bool is_mutual = true;                       ///< see law.hpp
  static constexpr bool is_hertzian = true;                     ///< the two touch as Hertz says
  static constexpr double damping_factor = 1.8257418583505538;  ///< 2 sqrt(5/6), of beta sqrt(stiffness m*)

  template <class S>
  COLLIDE_HD_INLINE normal_force<S> force(granular_pair<S> const& p, detail::contact_material const& m) const {
    S const overlap = detail::max(p.overlap, S(0)), a = detail::sqrt_rn(p.radius * overlap);
    return {S(4.0 / 3 * m.young) * a * overlap, S(2 * m.young) * a, a};
  }
};

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
