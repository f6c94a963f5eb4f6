/// \file
/// Sink: the closest colliding triangle of each sphere.
#pragma once

#include <collide/detail/sinks/per_sphere_min.hpp>

namespace collide {

/// The closest colliding triangle of a sphere.
template <class S>
struct nearest {
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
  template <class S>
  static COLLIDE_HD S& key_of(nearest<S>& entry) {
    return entry.distance;
  }
};

}  // namespace detail

/// The colliding triangle closest to each sphere's centre; of equally close ones that with the smallest id. Distances
/// are those of `contact::distance`. `query` waits once, for the number of pairs. `S` is the scalar of the detector.
/// Memory: an entry for each sphere, and a pair and a number for each colliding pair. For spheres at rest; of those
/// that move, `earliest` finds the first triangle.
template <class S = float>
class closest : public detail::per_sphere_min<nearest<S>, S, detail::distance_of_contact> {};

}  // namespace collide
