/// \file
/// Tangential force without memory.
#pragma once

#include <collide/effects/granular/law.hpp>

namespace collide {

/// A dashpot up to Coulomb's limit. Nothing is remembered: a pile creeps.
struct dashpot {
  static constexpr bool is_mutual = true;  ///< see law.hpp
  double damping = 0;                      ///< force per slip, not negative

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(damping), "dashpot: damping is not negative, and finite");
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> force(granular_pair<S> const& p, detail::contact_material const& m,
                                  normal_force<S> const& n, Memory const&) const {
    S const speed = detail::length_of(p.slip);
    S const force = detail::min(S(S(damping) * speed), detail::friction_limit(p, m, n));
    return detail::either(speed > 0, vec3<S>(p.slip * (-force / speed)), vec3<S>(S(0), S(0), S(0)));
  }
};

}  // namespace collide
