/// \file
/// Torques that resist torsion, which is turning about the normal, beside a law of rolling.
#pragma once

#include <collide/effects/granular/law.hpp>

namespace collide {

/// The angle by which a contact is twisted: the spring that resists torsion.
struct twist_angle : detail::number_column {};

namespace detail {

template <class Columns>
inline constexpr bool has_twist_angle = false;
template <class... C>
inline constexpr bool has_twist_angle<columns<C...>> = (std::is_same_v<C, twist_angle> || ...);

/// A law of rolling, and a spring, a dashpot and a slider about the normal.
template <class Rolling>
struct with_torsion {
  static_assert(!has_twist_angle<remembers_of<Rolling>>,
                "collide: torsion and marshall contain a law of rolling, and not a second law of torsion");
  using remembers = typename contact_columns_of<union_of<columns<twist_angle>, remembers_of<Rolling>>>::type;
  static constexpr bool is_mutual = is_mutual_law<Rolling>;          ///< see law.hpp
  static constexpr bool needs_hertz = detail::needs_hertz<Rolling>;  ///< the normal law must be `hertz`

 protected:
  /// The torque about the normal, with the spring cut so that spring and dashpot together are not above the limit.
  template <class S, class Memory>
  static COLLIDE_HD_INLINE vec3<S> wrench(granular_pair<S> const& p, Memory const& memory, S stiffness, S dash,
                                          S limit) {
    S& angle = memory[twist_angle{}];
    angle += p.twist * memory.elapsed();
    S const damped = dash * p.twist, torque = stiffness * angle + damped;
    auto const slides = torque > limit || torque < -limit;
    if (!any(slides)) return p.normal * -torque;
    S const sliding = either(torque < 0, S(-limit), limit);
    angle = either(slides && stiffness > 0, S((sliding - damped) / stiffness), angle);
    return p.normal * -either(slides, sliding, torque);
  }
};

}  // namespace detail

/// The torsion of a round contact of radius a whose surfaces stick by springs of stiffness k_t and dashpots eta_t:
/// k_t a^2 / 2, eta_t a^2 / 2, at most 2/3 a times the friction: J. S. Marshall, Journal of Computational Physics 228,
/// 2009; LAMMPS' `twisting marshall`.
///
/// \tparam Rolling  a law of rolling, or `none`
template <class Rolling = none>
struct marshall : detail::with_torsion<Rolling> {
  Rolling rolling{};           ///< parameters of the law of rolling
  double stiffness_ratio = 0;  ///< k_t over the normal stiffness, as of `cundall_strack`, not negative; 0: 8 G* a, as
                               ///< of `mindlin`
  double damping_ratio = 1;    ///< eta_t over the normal dashpot, not negative

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(stiffness_ratio) && detail::is_amount(damping_ratio),
                            "marshall: stiffness_ratio and damping_ratio are not negative, and finite");
    detail::check_part(rolling);
  }
  template <class F>
  void for_each_part(F const& f) {
    detail::for_each_part_of(rolling, f);
    f(stiffness_ratio);
    f(damping_ratio);
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> torque(granular_pair<S> const& p, detail::contact_material const& m,
                                   normal_force<S> const& n, Memory const& memory) const {
    S const a = n.contact_radius, half = a * a / 2;
    S const stiffness = stiffness_ratio > 0 ? S(stiffness_ratio) * n.stiffness : S(8 * m.shear) * a;
    return rolling.torque(p, m, n, memory) + this->wrench(p, memory, half * stiffness,
                                                          half * S(damping_ratio) * n.damping,
                                                          S(2.0 / 3) * a * detail::friction_limit(p, m, n));
  }
};

/// Torsion with constants of one's own: LAMMPS' `twisting sds`. With stiffness 0 it is a dashpot.
///
/// \tparam Rolling  a law of rolling, or `none`
template <class Rolling = none>
struct torsion : detail::with_torsion<Rolling> {
  Rolling rolling{};     ///< parameters of the law of rolling
  double stiffness = 0;  ///< torque per angle, not negative
  double damping = 0;    ///< torque per angular velocity, not negative
  double friction = 0;   ///< the largest torque over the normal force, a length, not negative

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(stiffness) && detail::is_amount(damping) && detail::is_amount(friction),
                            "torsion: stiffness, damping and friction are not negative, and finite");
    detail::check_part(rolling);
  }
  template <class F>
  void for_each_part(F const& f) {
    detail::for_each_part_of(rolling, f);
    f(stiffness);
    f(damping);
    f(friction);
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> torque(granular_pair<S> const& p, detail::contact_material const& m,
                                   normal_force<S> const& n, Memory const& memory) const {
    return rolling.torque(p, m, n, memory) +
           this->wrench(p, memory, S(stiffness), S(damping), S(friction) * n.holding(p));
  }
};

}  // namespace collide
