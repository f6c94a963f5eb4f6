/// \file
/// Sinks: the closest colliding triangle of each sphere, and the contact with it.
#pragma once

#include <collide/detail/sinks/per_sphere_min.hpp>

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

/// The contact of each sphere with the triangle that `closest` finds: point, normal, distance, depth and feature. Where
/// a sphere touches nothing, `triangle` is `no_id`, `distance` +infinity, `depth` -infinity, and `point` and `normal`
/// are NaN. As `closest` otherwise; it computes the contact of each sphere that touches something once more.
template <class S = float>
class closest_contact : public detail::per_sphere_min<contact<S>, S, detail::distance_of_contact> {};

}  // namespace collide
