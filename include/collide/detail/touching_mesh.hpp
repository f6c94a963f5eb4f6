/// \file
/// Contacts as a simulation needs them: where a ball that touches a triangle does so, without digits that nobody sees.
#pragma once

#include <collide/detail/contact_of.hpp>
#include <collide/detail/local_sweep.hpp>

namespace collide::detail {

/// The contact of a ball and a finite triangle. Unlike that of `contact_of`, the depth of a ball that just touches is
/// known to within the rounding of doubles only: resting balls do just that, all the time.
template <class S>
COLLIDE_HD contact<S> contact_here(triangle<S> const& t, sphere<S> const& s) {
  sphere<S> const centre{s.centre, S(0)};
  local_triangle<double> const l = normalised(relative<double>(t, centre), t, centre);
  auto const clear = [](double distance, double) { return distance >= clear_length; };
  auto const exactly = [t, centre] { return exact_triangle<>(t, centre); };
  return contact_from(l, s.centre.template cast<double>(), s.radius, clear, exactly);
}

/// Where a moving ball is at a time within the step.
template <class S>
COLLIDE_HD_INLINE sphere<S> ball_at(moving_sphere<S> const& s, S time) {
  return {s.centre + scaled(s.displacement, time), s.radius};
}

}  // namespace collide::detail
