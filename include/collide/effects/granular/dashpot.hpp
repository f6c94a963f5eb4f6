/// \file
/// Tangential force without memory.
#pragma once

#include <collide/effects/granular/law.hpp>

namespace collide {

/// A dashpot up to Coulomb's limit. Nothing is remembered: a pile creeps.
struct dashpot {
  double damping = 0;  ///< force per slip, not negative

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(damping), "dashpot: damping is not negative, and finite");
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> force(granular_pair<S> const& p, detail::contact_material const& m,
                                  normal_force<S> const& n, Memory const&) const {
    S const speed = detail::length_of(p.slip);
    if (!(speed > 0)) return {S(0), S(0), S(0)};
    return p.slip * (-detail::min(S(damping) * speed, detail::friction_limit(p, m, n)) / speed);
  }
};

}  // namespace collide
