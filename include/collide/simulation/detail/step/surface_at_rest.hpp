/// \file
/// A surface at rest, and how a particle moves that touches it. Its frame is the world, so all of this is the identity
/// of what moving_surface.hpp has for bodies.
#pragma once

#include <collide/simulation/detail/step/contact_history.hpp>
#include <collide/simulation/detail/step/mesh_contact.hpp>

namespace collide::detail {

/// The frame of what rests, where there is no other.
struct only_frame {};

template <class S>
struct motion_in_world {
  vec3<S> displacement;  ///< in the rest of the step; of a swept particle
  vec3<S> velocity;

  template <class History>
  COLLIDE_HD_INLINE S rounding(History const&) const {
    return 0;
  }
  /// The displacement relative to the surface of a contact that the particle has had.
  template <class Contact, class History>
  COLLIDE_HD_INLINE relative_displacement<S> relative_to(Contact const& c, History const&) const {
    return {displacement, c.normal.get(), S(0)};
  }
  template <class Contact>
  COLLIDE_HD_INLINE vec3<S> const& velocity_relative_to(Contact const&, vec3<S> const& in_world) const {
    return in_world;
  }
  template <class Contact>
  COLLIDE_HD_INLINE bool is_other_surface(Contact const&) const {
    return false;
  }
  /// How high a point is above the tangent plane of a contact.
  template <class Contact>
  COLLIDE_HD_INLINE S height_above(Contact const& c, vec3<S> const& point) const {
    return detail::height_above(c.point, c.normal, point);
  }
  /// Moves a place with the surface.
  COLLIDE_HD_INLINE void advect(stored_vec3<S>&) const {}
};

struct surface_at_rest {
  template <class S>
  COLLIDE_HD_INLINE vec3<S> const& velocity_seen(vec3<S> const& v) const {
    return v;
  }
  template <class S>
  COLLIDE_HD_INLINE vec3<S> const& start_seen(vec3<S> const& x) const {
    return x;
  }
  template <class S>
  COLLIDE_HD_INLINE vec3<S> const& acceleration_seen(vec3<S> const& dv) const {
    return dv;
  }
  template <class S>
  COLLIDE_HD_INLINE void set_surface(mesh_contact<S>& c) const {
    c.surface_velocity = vec3<S>(S(0), S(0), S(0));
    c.body = no_id;
  }
  template <class Active, class S>
  COLLIDE_HD_INLINE void record_contact(Active& a, mesh_contact<S> const& c) const {
    a.record_contact(c);
  }
  template <class Particle>
  COLLIDE_HD_INLINE void to_surface_frame(Particle&) const {}
  template <class Particle>
  COLLIDE_HD_INLINE void to_world_frame(Particle&) const {}
  /// True if it is part of a body that moves in this step.
  template <class Mesh>
  COLLIDE_HD_INLINE bool is_of_moving_body(Mesh const&) const {
    return false;
  }
  /// Leaves a particle, for the rest of the step, where it is on the surface.
  template <class Mesh, class Particle, class Active>
  COLLIDE_HD_INLINE void carry(Mesh const&, Particle&, Active const&) const {}
};

/// A touch of a particle and the mesh.
template <class S, class Surface, class Motion>
struct touch {
  sphere<S> here;
  Surface surface;
  Motion motion;  ///< as the surface sees it
};

// moving_surface.hpp has these functions for meshes of which parts move.

template <class Mesh>
COLLIDE_HD_INLINE only_frame frame_of(Mesh const&, id) {
  return {};
}
/// The sphere of a particle as its frame sees it, for the rest of the step.
template <class Mesh, class Active>
COLLIDE_HD_INLINE auto shape_seen(Mesh const&, Active const& a, only_frame) {
  return a.shape();
}
/// The motion of a particle, of which a frame sees `whole`, for the rest of the step.
template <class Mesh, class Active, class Shape>
COLLIDE_HD_INLINE auto motion_seen(Mesh const&, Active const&, only_frame, Shape const& whole) {
  using S = decltype(whole.radius);
  motion_in_world<S> m{};
  if constexpr (Active::is_swept) m.displacement = whole.displacement;
  return m;
}
/// The motion of a particle at a contact, at a time of the rest of the step. Takes the contact from its frame to the
/// world.
template <class Mesh, class Active, class Shape, class S>
COLLIDE_HD_INLINE auto contact_in_world(Mesh const& mesh, Active const& a, Shape const& whole, S, contact<S>&) {
  return motion_seen(mesh, a, only_frame{}, whole);
}
/// The touch of a particle and the mesh at a time of the rest of its step. `Turns`: it may turn with a body.
template <bool Turns, class Mesh, class Active, class S>
COLLIDE_HD_INLINE touch<S, surface_at_rest, motion_in_world<S>> touch_at(Mesh const& mesh, Active const& a,
                                                                         contact<S> const&, S time) {
  return {sphere_at(a.shape(), time), {}, motion_seen(mesh, a, only_frame{}, a.shape())};
}

}  // namespace collide::detail
