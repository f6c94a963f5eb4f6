/// \file
/// Torques that resist rolling, and, beside these, torsion, which is turning about the normal.
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
