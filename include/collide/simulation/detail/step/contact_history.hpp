/// \file
/// The place of a particle in its step, and the contacts with the mesh that it has had in it.
///
/// `Seen` is its motion as a surface sees it: `motion_in_world` of surface_at_rest.hpp, or `motion_on_body` of
/// moving_surface.hpp.
#pragma once

#include <cstdint>

#include <collide/core/contact.hpp>
#include <collide/effects/effect.hpp>

namespace collide::detail {

/// How many of the contacts that a particle has had are recorded: the last ones.
inline constexpr int max_recorded_contacts = 3;

/// A vector in scratch memory, which is not constructed.
template <class S>
struct stored_vec3 {
  S components[3];

  COLLIDE_HD_INLINE void set(vec3<S> const& v) {
    for (int k = 0; k < 3; ++k) components[k] = v[k];
  }
  COLLIDE_HD_INLINE vec3<S> get() const { return {components[0], components[1], components[2]}; }
};

template <class S>
COLLIDE_HD_INLINE S height_above(stored_vec3<S> const& on_plane, stored_vec3<S> const& normal, vec3<S> const& x) {
  S above = 0;
  for (int k = 0; k < 3; ++k) above += normal.components[k] * (x[k] - on_plane.components[k]);
  return above;
}

/// A contact that a particle has had in this step.
template <class S, bool HasBodies>
struct recorded_contact {
  stored_vec3<S> normal, point;
};
template <class S>
struct recorded_contact<S, true> {
  stored_vec3<S> normal, point;
  stored_vec3<S> surface_velocity;
  stored_vec3<S> own_normal, own_point;  ///< in the frame of the body that was touched
  int frame;                             ///< of that body
};

/// A displacement relative to a surface: its normal, and how far rounding may move what rests along it.
template <class S>
struct relative_displacement {
  vec3<S> displacement, normal;
  S rounding;
};

/// State of a swept particle alone.
template <class S, bool IsSwept>
struct remaining_motion {};
template <class S>
struct remaining_motion<S, true> {
  stored_vec3<S> displacement;
  S remaining_time;                     ///< of the step, after the contacts so far
  id triangles[max_recorded_contacts];  ///< of the recorded contacts
};

/// A particle's place and its contacts. Plain numbers: scratch memory is not constructed.
template <class S, bool IsSwept, bool HasBodies>
struct contact_history : remaining_motion<S, IsSwept> {
  static constexpr bool is_swept = IsSwept;

  stored_vec3<S> centre;
  S radius;
  recorded_contact<S, HasBodies> contacts[max_recorded_contacts];  ///< not set before there is one
  S last_impulse;                                                  ///< with which the last one repelled the particle
  stored_vec3<S> arrival_velocity, start;  ///< before the contacts at this place, and where it led from
  std::uint8_t contact_count;              ///< contacts so far in this step
  std::uint8_t contacts_here;              ///< those of them at this place
  bool is_at_rest;                         ///< it had no velocity relative to the surface after the last contact

  COLLIDE_HD_INLINE auto shape() const {
    sphere<S> const here{centre.get(), radius};
    if constexpr (IsSwept) {
      return moving_sphere<S>{here, motion()};
    } else {
      return here;
    }
  }
  /// How a swept particle moves for the rest of its step.
  COLLIDE_HD_INLINE vec3<S> motion() const { return this->displacement.get(); }

  COLLIDE_HD_INLINE void place(vec3<S> const& at, [[maybe_unused]] vec3<S> const& motion) {
    centre.set(at);
    if constexpr (IsSwept) this->displacement.set(motion);
  }

  /// Records a contact, and returns it for what is known of its surface besides.
  COLLIDE_HD_INLINE recorded_contact<S, HasBodies>& record_contact(mesh_contact<S> const& c) {
    int const slot = contact_count % max_recorded_contacts;
    contacts[slot].normal.set(c.normal);
    contacts[slot].point.set(c.point);
    last_impulse = c.normal_impulse;
    if constexpr (IsSwept) this->triangles[slot] = c.triangle;
    ++contact_count;
    ++contacts_here;
    return contacts[slot];
  }
  COLLIDE_HD_INLINE recorded_contact<S, HasBodies> const& before_last(int i) const {
    return contacts[(contact_count - 1 - i) % max_recorded_contacts];
  }

  /// Begins with the contacts at a place: all in a step, but those of a particle that moves on to the next one.
  template <class Seen>
  COLLIDE_HD_INLINE void begin_contact_place(S time, vec3<S> const& velocity, vec3<S> const& from, Seen const& seen) {
    bool is_same_place = contact_count > 0;
    if constexpr (IsSwept) {
      vec3<S> const moved = scaled(seen.displacement, time);
      is_same_place = is_same_place && dot(moved, moved) <= S(1e-6) * radius * radius;
    }
    if (is_same_place) {
      if constexpr (IsSwept) seen.advect(start);
      return;
    }
    contacts_here = 0;
    arrival_velocity.set(velocity);
    start.set(from);
  }

  /// Shifts the start of a particle that a moved surface has pushed by `height`: where it is held at the contacts that
  /// follow, it is there.
  COLLIDE_HD_INLINE void offset_start(mesh_contact<S> const& c, S height) {
    if (overlaps(height)) start.set(start.get() + c.wedge_direction * height);
  }

  /// True of a swept particle's triangle that it has touched before and leaves: no part of that is above the tangent
  /// plane. To judge it once more would take exact arithmetic, as the distance is the radius.
  template <class Seen>
  COLLIDE_HD_INLINE bool is_leaving([[maybe_unused]] id triangle, [[maybe_unused]] Seen const& seen) const {
    bool leaves = false;
    if constexpr (IsSwept) {
      for (int i = 0; i < max_recorded_contacts && i < contact_count; ++i) {
        leaves = leaves || (this->triangles[i] == triangle && !is_approaching(seen.relative_to(contacts[i], *this)));
      }
    }
    return leaves;
  }

  /// True if a point of the mesh is part of the same surface as a recorded contact: not above its tangent plane. So
  /// inner edges of a surface that is divided into triangles are not felt. Two bodies are one surface if the particle
  /// approaches neither.
  template <class Seen>
  COLLIDE_HD_INLINE bool is_internal_contact(vec3<S> const& point, Seen const& seen) const {
    bool is_internal = false;
    for (int i = 0; i < max_recorded_contacts; ++i) {
      if (i >= contact_count) break;
      auto const& c = contacts[i];
      bool leaves = true;
      if constexpr (IsSwept) {
        leaves = !is_approaching(seen.relative_to(c, *this));
        if (seen.is_other_surface(c)) leaves = leaves && !is_approaching(c.normal.get(), seen);
      }
      is_internal = is_internal || (leaves && seen.height_above(c, point) <= contact_tolerance<S> * radius);
    }
    return is_internal;
  }

  /// True if a displacement leads towards a surface, by more than rounding, and not only along it.
  COLLIDE_HD_INLINE bool is_approaching(relative_displacement<S> const& d) const {
    S const into = -dot(d.displacement, d.normal);
    constexpr S tolerance = contact_tolerance<S>;
    return into > d.rounding &&
           (into * into > tolerance * tolerance * dot(d.displacement, d.displacement) || into > radius / 4);
  }
  template <class Seen>
  COLLIDE_HD_INLINE bool is_approaching(vec3<S> const& normal, Seen const& seen) const {
    return is_approaching({seen.displacement, normal, seen.rounding(*this)});
  }

  /// True if so deep an overlap with the mesh is more than rounding.
  COLLIDE_HD_INLINE bool overlaps(S depth) const {
    return depth > contact_tolerance<S> * radius + rounding_at(centre.get());
  }
};

/// Finds how to leave a contact such that this leaves the particle on the surfaces of those before it at this place:
/// the projection of the normal onto what they leave free. They count where the normal leads into them, and a single
/// one also where it leads off it but pushed harder than that relieves it, as in the two sides of an open groove.
/// `seen` knows the velocity that the surface of the contact sees; `velocity` is that in the world.
template <class S, bool IsSwept, bool HasBodies, class Seen>
COLLIDE_HD_INLINE void project_onto_contacts(contact_history<S, IsSwept, HasBodies> const& history, mesh_contact<S>& c,
                                             vec3<S> const& velocity, Seen const& seen) {
  vec3<S> const& n = c.normal;
  c.wedge_direction = n;
  c.unconstrained_dv = std::numeric_limits<S>::max();
  int const count = min(int{history.contacts_here}, max_recorded_contacts);
  if (count == 0) return;
  auto const last = [&](int i) { return history.before_last(i).normal.get(); };
  int opposed = -1;
  S along = 0;
  for (int i = 0; i < count; ++i) {
    S const with = dot(n, last(i));
    if (with >= along) continue;
    along = with;
    opposed = i;
  }
  vec3<S> out = n;
  S free = 0;
  if (opposed >= 0) {
    vec3<S> const wall = last(opposed);
    free = max(dot(seen.velocity_relative_to(history.before_last(opposed), velocity), wall), S(0)) / -along;
    out -= wall * along;
    for (int i = 0; i < count; ++i) {
      if (i == opposed || dot(out, last(i)) >= -contact_tolerance<S>) continue;
      vec3<S> const edge = cross(wall, last(i));
      out = edge * (dot(n, edge) / dot(edge, edge));
      free = 0;
    }
  } else if (count == 1) {
    vec3<S> const wall = last(0);
    S const with = dot(n, wall), apart = 1 - with * with;  // the square of the sine of the angle between the two
    S const relief = 2 * with * max(-dot(seen.velocity, n), S(0));
    if (!(apart > S(1e-2) && relief <= history.last_impulse * apart)) return;
    out -= wall * with;
  } else {
    return;
  }
  S const height = dot(out, n);
  if (!(height > S(1e-4))) return;  // between two walls that are nearly parallel
  c.wedge_direction = out * (1 / height);
  c.unconstrained_dv = free;
}

}  // namespace collide::detail
