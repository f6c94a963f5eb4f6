/// \file
/// The interface of effects: what happens to a particle in a step of a simulation.
///
/// An effect is a small copyable struct with its parameters. docs/development/extending.md lists its members and when
/// they are called: the columns that it works on, such as `reads` and `writes`; those for each particle, from
/// `is_inactive` to `end_step`, each `COLLIDE_HD`, const, and a template over the type of the particle; and those on
/// the host, `begin_step`, `check_parameters` and `longest_step`.
///
/// A particle is a value in registers: `p[velocity{}]` is a reference to its velocity, `p.radius()` and `p.number()`
/// are its radius and its number, and `Particle::template has<C>` tells whether the scene has the column C. An effect
/// that asks for the radius where nothing is touched, in `accelerate` or `end_step`, says
/// `optional_reads = columns<radius>`. Members are called in the order of the scene's list. What a scene does not name
/// costs nothing: neither memory nor instructions.
#pragma once

#include <string>
#include <type_traits>
#include <utility>

#include <collide/core/contact.hpp>
#include <collide/core/detail/detected.hpp>
#include <collide/core/error.hpp>
#include <collide/effects/columns.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>

namespace collide {

/// The smallest radii of a simulation's particles, by which effects know how long a step may be.
struct smallest_radii {
  static constexpr int numbers = 32;  ///< of materials

  double of_all = 0;                 ///< of all particles
  double of_material[numbers] = {};  ///< of those of each material, the last also of greater numbers; infinite if none
  int largest_material = -1;         ///< the greatest number of those that particles have; -1: not known

  smallest_radii() = default;
  /// Nothing is known about materials: there may be particles of each.
  explicit smallest_radii(double radius) : of_all{radius} {
    for (double& r : of_material) r = radius;
  }
};

namespace detail {

/// Differences in height, in radii, and in slope that are put down to rounding.
template <class S>
inline constexpr S contact_tolerance = sizeof(S) == sizeof(float) ? S(1e-5) : S(1e-9);

/// The rounding of a position: at least 1 unit in the last place of its largest coordinate.
template <class S>
COLLIDE_HD_INLINE S rounding_at(vec3<S> const& position) {
  return std::numeric_limits<S>::epsilon() * max_component<S>(detail::absolute(position));
}

/// The mass of a sphere.
template <class S>
COLLIDE_HD_INLINE S sphere_mass(double density, S radius) {
  return S(4.188790204786391) * S(density) * radius * radius * radius;  // 4 pi / 3
}

/// Throws `error`, which says what a parameter must be, unless it is that.
inline void check_parameter(bool is_right, char const* must) {
  if (!is_right) throw error(std::string("collide: ") + must);
}

/// True of a finite number that is not negative, and of one above 0.
inline bool is_amount(double x) { return x >= 0 && is_finite(x); }
inline bool is_positive(double x) { return x > 0 && is_finite(x); }
inline bool is_finite(double const (&x)[3]) { return is_finite(x[0]) && is_finite(x[1]) && is_finite(x[2]); }

template <class E>
using check_parameters_call = decltype(std::declval<E const&>().check_parameters());

/// Calls `check_parameters` of an effect, or of a part of one, if it has it.
template <class E>
void check_part(E const& effect) {
  if constexpr (is_valid<check_parameters_call, E>) effect.check_parameters();
}

/// True for an effect whose `end_step` asks what the forces are.
COLLIDE_MEMBER_OR(asks_forces, asks_forces, false)

/// True for an effect by which space repeats, from its `lower` to its `upper`.
COLLIDE_MEMBER_OR(repeats_space, repeats_space, false)

/// True for a source of particles.
COLLIDE_MEMBER_OR(is_source, makes_particles, false)

/// True if what an effect, or a part of it, has in memory means the same in another process.
COLLIDE_MEMBER_OR(saves_parameters, saves_parameters, true)

/// f(part) for each part of an effect's parameters that has no padding, for checkpoints: what its `for_each_part(f)`
/// gives, or all of it. Nothing of what is empty, or of what says that it is not saved.
template <class E, class F>
using for_each_part_call = decltype(std::declval<E&>().for_each_part(std::declval<F const&>()));
template <class E, class F>
void for_each_part_of(E& of, F const& f) {
  if constexpr (std::is_class<E>::value && !saves_parameters<E>) {
    return;
  } else if constexpr (is_valid<for_each_part_call, E, F>) {
    of.for_each_part(f);
  } else if constexpr (!std::is_empty<E>::value) {
    f(of);
  }
}

/// Number of the body of a frame; 0 is that of what rests.
COLLIDE_HD_INLINE id body_of_frame(int frame) { return frame == 0 ? no_id : static_cast<id>(frame - 1); }

}  // namespace detail

/// The impulse from the mesh to a particle, as `on_mesh_impulse` gets it: changes per mass, in the world.
template <class S>
struct mesh_impulse {
  vec3<S> change;       ///< of the velocity
  vec3<S> spin_change;  ///< of the angular velocity; 0 without `spin` in the scene
  vec3<S> centre;       ///< of the particle, before
  vec3<S> shift;        ///< of the centre, out of the surface, or with a body to which it sticks
  vec3<S> velocity;     ///< of the particle, after
  id triangle;          ///< number of the triangle; `no_id` of what is held or sleeps
  id body;              ///< number of the body whose surface it is; `no_id` of what rests
};

/// A contact of a particle with the surface of the mesh, as `on_mesh_overlap` gets it: a point that is nearest to the
/// centre among all around.
///
/// Where the surface within the sphere leads from a contact to a deeper one, as in a shallow fold, the two are parts of
/// one: the contact counts only from its own overlap down to that at the saddle between them. A force that is to be
/// independent of how a surface is divided, and to make no energy, is that of the contact less what the same law gives
/// at the saddle.
template <class S>
struct mesh_overlap {
  static constexpr S apart = -std::numeric_limits<S>::max();  ///< `saddle_overlap` where there is no saddle

  vec3<S> normal;                                ///< unit vector to the centre
  S overlap;                                     ///< radius minus distance, above 0
  vec3<S> surface_velocity;                      ///< of the surface at the point, in the world: 0 of what rests
  id triangle;                                   ///< number of the triangle
  id body;                                       ///< number of the body whose surface it is; `no_id` of what rests
  vec3<S> saddle_normal = {S(0), S(0), S(0)};    ///< unit vector from the saddle to the centre
  S saddle_overlap = apart;                      ///< radius minus distance of the saddle: at most `overlap`
  vec3<S> surface_turning = {S(0), S(0), S(0)};  ///< angular velocity of the body; 0 of what rests or deforms

  /// True if the contact joins a deeper one.
  COLLIDE_HD_INLINE bool has_saddle() const { return saddle_overlap > apart; }
};

/// A particle's contact with the mesh, as `on_mesh_contact` gets it. `depth` is how deep the triangle still is in the
/// sphere, where the particle is now: an effect that pushes the particle out takes off what it pushed.
///
/// If a particle touches several triangles at the same place, each contact knows of those before it. In a groove
/// the surface of the second can only be left along the first: `push_out` and `repel` do so.
template <class S>
struct mesh_contact : contact<S> {
  vec3<S> force_dv;         ///< what a step's acceleration adds to the velocity
  vec3<S> start;            ///< the centre when the step began; of a swept particle where it was stopped
  S elapsed;                ///< for how long the particle has moved from there, in the units of `dt`
  S remaining;              ///< what is left of the step for a swept particle, in the units of `dt`; else 0
  vec3<S> velocity_before;  ///< the particle's velocity before this contact
  S approach_speed;         ///< speed towards the surface, before the contacts at this place changed it
  vec3<S>
      wedge_direction;  ///< displacement that raises the particle above the surface by 1, and leaves it on those before
  S unconstrained_dv;   ///< change of speed along the normal up to which no contact before is pressed on
  S normal_impulse;     ///< what the effects have added to the velocity along the normal: 0, or what repels
  S friction_reserve;   ///< impulse along the surface that static friction has in reserve; 0 where the particle slides
  bool is_resting;      ///< an effect has found that the particle rests on the surface, or slides on it
  vec3<S> surface_velocity;  ///< of the surface at the point, in the world: 0 of what rests; see bodies.hpp
  id body;                   ///< number of the body whose surface it is; `no_id` of what rests

  /// Raises a particle above the surface by `height`.
  COLLIDE_HD_INLINE void push_out(vec3<S>& position, S height) {
    position += wedge_direction * height;
    this->depth -= height;
  }

  /// Makes a particle leave the surface faster by `change` > 0.
  COLLIDE_HD_INLINE void repel(vec3<S>& velocity, S change) {
    S const direct = detail::min(change, unconstrained_dv), wedged = change - direct;
    velocity += this->normal * direct + wedge_direction * wedged;
    normal_impulse += direct + wedged * detail::dot(wedge_direction, wedge_direction);
  }

  /// Stops a particle that something holds: its velocity is 0, and it is where it was when the step began, raised or
  /// lowered to the surface if it was not there to rounding. So what is held does not creep.
  template <class Particle>
  COLLIDE_HD_INLINE void hold(Particle& p) {
    p[velocity{}] = vec3<S>(S(0), S(0), S(0));
    this->depth += detail::dot(this->normal, vec3<S>(p[position{}] - start));
    p[position{}] = start;
    S const rounding = detail::contact_tolerance<S> * p.radius() + detail::rounding_at(start);
    if (this->depth > rounding || this->depth < -rounding) push_out(p[position{}], this->depth);
  }
};

}  // namespace collide
