/// The stages of a verdict, and the ball of the broad phase, one by one.
#pragma once

#include <collide/detail/bounding_sphere.hpp>
#include <collide/detail/decide.hpp>

namespace tests {

/// Whether a stage gives a wrong verdict, or drops a pair that touches. `hit` is the truth.
template <class S>
bool some_stage_is_wrong(collide::triangle<S> const& t, collide::sphere<S> const& s, bool hit) {
  namespace detail = collide::detail;
  bool const sound = detail::finite(t) && detail::finite(s.centre) && detail::valid_radius(s.radius);
  return detail::decide(t, s).hit != hit || detail::decide_closely(t, s).hit != hit ||
         (sound && !detail::infinite(s.radius) && detail::exact_triangle(t, s).in_reach() != hit) ||
         (hit && !detail::bounds_of(t).reached(s.centre, s.radius));
}

}  // namespace tests
