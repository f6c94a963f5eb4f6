/// \file
/// Sinks: the closest colliding triangle of each sphere, and the contact with it.
#pragma once

#include <collide/sinks/detail/per_sphere_min.hpp>

namespace collide {

/// The closest colliding triangle of a sphere.
template <class S>
struct closest_triangle {
  id triangle;  ///< `no_id` if the sphere touches nothing
  S distance;   ///< from the centre to the triangle; +infinity if the sphere touches nothing
};

namespace detail {

struct distance_of_contact {
  template <class NarrowPhase, class S>
  static COLLIDE_HD S of(hit<NarrowPhase, S> const& h) {
    static_assert(is_discrete<NarrowPhase, S>,
                  "collide: closest is for spheres that rest: of those that move, earliest finds the first impact");
    return h.contact().distance;
  }
  template <class Entry>
  static COLLIDE_HD auto& key_of(Entry& entry) {
    return entry.distance;
  }
};

}  // namespace detail

/// The colliding triangle closest to each sphere's centre; of equally close ones that with the smallest id. Distances
/// are those of `contact::distance`. `query` waits once, for the number of pairs. `S` is the scalar of the detector.
/// Memory: an entry for each sphere, and a pair and a number for each colliding pair. For spheres at rest; of those
/// that move, `earliest` finds the first triangle.
template <class S = float>
class closest : public detail::per_sphere_min<closest_triangle<S>, S, detail::distance_of_contact> {};

/// The contact of each sphere with the triangle that `closest` finds: point, normal, distance, depth and feature. Of a
/// sphere that touches nothing `sphere` and `triangle` are `no_id`, `distance` is +infinity, and point, normal and
/// depth are NaN. As `closest` otherwise, with memory for a contact of each sphere; one more is computed for each that
/// touches.
template <class S = float>
class closest_contact : public detail::per_sphere_min<closest_triangle<S>, S, detail::distance_of_contact, contact<S>> {
};

}  // namespace collide
