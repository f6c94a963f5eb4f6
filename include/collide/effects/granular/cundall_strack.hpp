/// \file
/// Tangential force of a linear spring that remembers.
#pragma once

#include <collide/effects/granular/mindlin.hpp>

namespace collide {

/// A spring whose stiffness is a part of the normal one, a dashpot whose constant is a part of the normal one, and a
/// slider at Coulomb's limit: P. A. Cundall and O. D. L. Strack, Geotechnique 29(1), 1979. With `linear` it is LAMMPS'
/// `gran/hooke/history`, by default as there (k_t = 2/7 k_n, gamma_t = 1/2 gamma_n), or with others of these members
/// `granular hooke ... tangential linear_history`, MercuryDPM's LinearViscoelasticFriction (2/7, 2/7) or LIGGGHTS'
/// `hooke tangential history` (1, 1, `slip_test::spring`). With `hertz` the stiffnesses are 2 E* a and a part of it.
struct cundall_strack {
  static constexpr bool is_mutual = true;  ///< see law.hpp
  using remembers = contact_columns<tangential_displacement>;

  double stiffness_ratio = 2.0 / 7;                ///< k_t / k_n, above 0
  double damping_ratio = 0.5;                      ///< of the dashpots, tangential over normal, not negative
  slip_test test = slip_test::spring_and_dashpot;  ///< what slides
  bool keeps_length = false;        ///< the spring does not become shorter where it turns with the contact
  bool turns_about_normal = false;  ///< the spring turns with the spins of the two about the normal, too

  void check_parameters() const {
    detail::check_parameter(detail::is_positive(stiffness_ratio),
                            "cundall_strack: stiffness_ratio is above 0, and finite");
    detail::check_parameter(detail::is_amount(damping_ratio),
                            "cundall_strack: damping_ratio is not negative, and finite");
  }

  /// f(parameter) for each, for checkpoints: there is padding behind them.
  template <class F>
  void for_each_part(F const& f) {
    f(stiffness_ratio);
    f(damping_ratio);
    f(test);
    f(keeps_length);
    f(turns_about_normal);
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> force(granular_pair<S> const& p, detail::contact_material const& m,
                                  normal_force<S> const& n, Memory const& memory) const {
    return detail::spring_force(*this, p, m, n, memory, S(stiffness_ratio) * n.stiffness, S(damping_ratio) * n.damping);
  }

  /// The energy of the spring: stiffness times the square of its length, over 2.
  template <class S, class Memory>
  COLLIDE_HD_INLINE S energy(granular_pair<S> const&, detail::contact_material const&, normal_force<S> const& n,
                             Memory const& memory) const {
    vec3<S> const& spring = memory[tangential_displacement{}];
    return S(stiffness_ratio / 2) * n.stiffness * detail::dot(spring, spring);
  }
};

}  // namespace collide
