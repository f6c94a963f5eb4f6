/// \file
/// The contact of a moving sphere at a time of the step.
#pragma once

#include <collide/exact/detail/geometry/local_sweep.hpp>
#include <collide/narrow/detail/contact.hpp>

namespace collide::detail {

/// The contact at a time within the step. At the time of impact its depth is next to zero, and accurate to absolute
/// rounding only.
COLLIDE_HD_NOINLINE inline contact<double> contact_at_time(triangle<double> const& t, moving_sphere<double> const& s,
                                                           double time, digits wanted) {
  if (time == 0) return contact_of_pair(t, static_cast<sphere<double> const&>(s), wanted, true);
  moving_sphere<double> const centre{{s.centre, 0}, s.displacement};
  local_sweep<double> const l = to_unit_range(to_local<double>(t, centre), t, centre);
  return contact_with_fallback(at_time(l, time), s.centre + scaled(s.displacement, time), t, s, time, wanted, false);
}

template <class S>
COLLIDE_HD contact<S> contact_at_time(triangle<S> const& t, moving_sphere<S> const& s, S time) {
  return narrow_to<S>(contact_at_time(widened(t), widened(s), static_cast<double>(time), digits_of<S>));
}

}  // namespace collide::detail
