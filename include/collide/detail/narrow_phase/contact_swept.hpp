/// \file
/// The contact of a moving sphere at a time of the step.
#pragma once

#include <collide/detail/geometry/local_sweep.hpp>
#include <collide/detail/narrow_phase/contact.hpp>

namespace collide::detail {

/// The contact at a time within the step. At the time of impact its depth is next to zero, and accurate to absolute
/// rounding only.
COLLIDE_HD_NOINLINE inline contact<double> contact_at(triangle<double> const& t, moving_sphere<double> const& s,
                                                      double time, double enough) {
  if (time == 0) return contact_between(t, static_cast<sphere<double> const&>(s), enough, true);
  local_sweep<double> const l = normalised(relative<double>(t, s), t, s);
  return contact_from(seen_at(l, time), s.centre + scaled(s.displacement, time), t, s, time, enough, false);
}

template <class S>
COLLIDE_HD contact<S> contact_at(triangle<S> const& t, moving_sphere<S> const& s, S time) {
  return rounded<S>(contact_at(widened(t), widened(s), static_cast<double>(time), enough_for<S>));
}

}  // namespace collide::detail
