/// \file
/// How a particle leaves a surface in a corner: along those that it touches already.
#pragma once

#include <collide/simulation/detail/step/contact_history.hpp>

namespace collide::detail {

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
