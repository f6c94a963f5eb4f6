/// \file
/// Sinks: the first triangle that each moving sphere hits, and the impact.
#pragma once

#include <collide/sinks/detail/per_sphere_min.hpp>

namespace collide {

/// The triangle that a sphere hits first within the step.
template <class S>
struct first_impact {
  id triangle;  ///< `no_id` if the sphere touches nothing
  S time;       ///< in 0 .. 1; +infinity if the sphere touches nothing
};

namespace detail {

struct time_of_hit {
  template <class NarrowPhase, class S>
  static COLLIDE_HD S of(hit<NarrowPhase, S> const& h) {
    return h.impact().time;
  }
  template <class Entry>
  static COLLIDE_HD auto& key_of(Entry& entry) {
    return entry.time;
  }
};

}  // namespace detail

/// The triangle with the smallest time of impact of each moving sphere; of equal times that with the smallest id. Needs
/// a narrow phase for spheres that move. `query` waits once, for the number of pairs. `S` is the scalar of the
/// detector.
template <class S = float>
class earliest : public detail::per_sphere_min<first_impact<S>, S, detail::time_of_hit> {};

/// The impact of each moving sphere on the triangle that `earliest` finds: its time, and the contact then. Of a sphere
/// that touches nothing `contact.sphere` and `contact.triangle` are `no_id`, `time` is +infinity, and the numbers of
/// the contact are NaN. As `earliest` otherwise, with memory for an impact of each sphere; one more is computed for
/// each that touches.
template <class S = float>
class earliest_impact : public detail::per_sphere_min<first_impact<S>, S, detail::time_of_hit, impact<S>> {};

}  // namespace collide
