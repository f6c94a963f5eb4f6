/// \file
/// Normal force of elastic spheres.
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

}  // namespace collide
