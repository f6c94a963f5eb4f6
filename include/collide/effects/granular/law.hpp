/// \file
/// The arguments and results of a law of granular contact: normal, tangential, rolling, cohesion. See
/// granular_contact.hpp.
///
/// A law is a small copyable struct. It may name what a contact remembers for it, `using remembers =
/// contact_columns<...>`, and has one member template, `COLLIDE_HD`, const:
///   - normal: `normal_force<S> force(granular_pair<S> const&, contact_material const&)`;
///   - cohesion: `void pull(normal_force<S>&, granular_pair<S> const&, contact_material const&, Memory const&)`; if it
///     remembers something and pulls where the two are apart, `static constexpr double farther`, in radii of the
///     sphere, says how far it is from a wall then at most;
///   - tangential: `vec3<S> force(granular_pair<S> const&, contact_material const&, normal_force<S> const&,
///     Memory const&)`, on the particle, at right angles to the normal; and, if it has a spring, `S energy(...)` with
///     the same arguments, for `energy` of a simulation;
///   - rolling: `vec3<S> torque(...)` with the same arguments, on the particle.
/// A law that does to one of two spheres the opposite of what it does to the other says so: `static constexpr bool
/// is_mutual = true`. On a CPU it is asked once a pair then, and some pairs at a time: S may be a `detail::pack`, for
/// which `any` and `either` take the place of branches (exact/detail/numeric/pack.hpp). What such a law remembers as
/// `vec3<S>` has the opposite sign for the other sphere, what it remembers as S the same. `memory[column{}]` is what
/// the contact remembers, `memory.elapsed()` for how long the contact has moved since it was looked at before.
#pragma once

#include <collide/effects/detail/particle_access.hpp>
#include <collide/effects/granular/materials.hpp>
#include <collide/exact/detail/numeric/pack.hpp>

namespace collide {

/// Two spheres in contact, or a sphere and a wall, as laws see them.
template <class S>
struct granular_pair {
  vec3<S> normal;   ///< unit vector from the other to the particle
  S overlap;        ///< by how much the two are in each other; below 0: they are apart
  S closing;        ///< speed at which the overlap grows
  vec3<S> slip;     ///< velocity of the particle's surface against the other's, at right angles to the normal
  vec3<S> turning;  ///< angular velocity of the particle minus that of the other, without the part along the normal;
                    ///< of a wall `own_turning`, also if the wall turns, as in LIGGGHTS
  vec3<S> own_turning;   ///< angular velocity of the particle, without the part along the normal
  S radius;              ///< effective: 1/R* = 1/R_i + 1/R_j; of a wall R
  S mass;                ///< effective: 1/m* = 1/m_i + 1/m_j; of a wall m
  S rolling_inertia;     ///< 1.4 (m_i R_i^2 m_j R_j^2) / (m_i R_i^2 + m_j R_j^2); of a wall 1.4 m R^2
  S own_radius;          ///< of the particle
  bool is_wall = false;  ///< the other is a wall
  S twist = 0;           ///< angular velocity of the particle minus that of the other, along the normal
  S spin = 0;            ///< the mean of both angular velocities along the normal: by which the contact turns
};

/// The force along the normal.
template <class S>
struct normal_force {
  S elastic;         ///< what is not of damping; below 0: it pulls
  S stiffness;       ///< change of the elastic force with the overlap
  S contact_radius;  ///< of the area of contact
  S damping = 0;     ///< force per closing speed: damping_factor beta sqrt(stiffness m*), after cohesion
  S pull_off = 0;    ///< the largest pull of cohesion (`sjkr`: half its pull), twice of which friction does not feel
  S secant = 0;      ///< elastic force over overlap, as of the normal law without cohesion; of `jkr` as of its area
  detail::mask_of<S> goes_on = false;  ///< the two hold each other, though apart

  /// The force along the normal, with damping.
  COLLIDE_HD_INLINE S total(granular_pair<S> const& p) const { return elastic + damping * p.closing; }
  /// The force by which sliding and rolling friction are limited: |total + 2 pull_off|.
  COLLIDE_HD_INLINE S holding(granular_pair<S> const& p) const {
    S const force = total(p) + 2 * pull_off;
    return detail::either(force < 0, S(-force), force);
  }
};

/// The radius of the area of contact when the contact was looked at before.
struct contact_radius : detail::number_column {};

/// In place of a law: no force, no torque, nothing that is remembered.
struct none {
  static constexpr bool is_mutual = true;  ///< see law.hpp

  template <class S, class Memory>
  COLLIDE_HD_INLINE void pull(normal_force<S>&, granular_pair<S> const&, detail::contact_material const&,
                              Memory const&) const {}
  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> force(granular_pair<S> const&, detail::contact_material const&, normal_force<S> const&,
                                  Memory const&) const {
    return {S(0), S(0), S(0)};
  }
  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> torque(granular_pair<S> const&, detail::contact_material const&, normal_force<S> const&,
                                   Memory const&) const {
    return {S(0), S(0), S(0)};
  }
};

namespace detail {

template <class List>
struct contact_columns_of;
template <class... C>
struct contact_columns_of<columns<C...>> {
  using type = contact_columns<C...>;
};

COLLIDE_MEMBER_OR(needs_hertz, needs_hertz, false)
COLLIDE_MEMBER_OR(is_mutual_law, is_mutual, false)
template <class L>
using stiffness_ratio_member = decltype(L::stiffness_ratio);

/// The stiffness of a tangential spring over that of the normal one; 0 of laws without such a member.
template <class L>
double stiffness_ratio_of([[maybe_unused]] L const& law) {
  if constexpr (is_valid<stiffness_ratio_member, L>) return law.stiffness_ratio;
  return 0;
}

/// Turns a vector of the plane of contact about the normal, by the mean spin of the two, by the tangent of half the
/// angle: it keeps its length.
template <class S>
COLLIDE_HD_INLINE void turn_about_normal(vec3<S>& v, granular_pair<S> const& p, S elapsed) {
  S const half = p.spin * elapsed / 2, by = 2 / (1 + half * half);
  v += (cross(p.normal, v) - v * half) * (by * half);
}

/// Coulomb's limit of friction.
template <class S>
COLLIDE_HD_INLINE S friction_limit(granular_pair<S> const& p, contact_material const& m, normal_force<S> const& n) {
  return S(m.friction) * n.holding(p);
}

}  // namespace detail

}  // namespace collide
