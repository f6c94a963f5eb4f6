/// \file
/// The contact of a moving sphere, when it touches.
#pragma once

#include <collide/detail/geometry/local_sweep.hpp>
#include <collide/detail/narrow_phase/contact.hpp>
#include <collide/detail/predicates/exact_swept.hpp>

namespace collide::detail {

/// The contact at a time within the step; the depth, which is next to zero when the contact begins, is just that.
template <class S>
COLLIDE_HD contact<S> contact_at(triangle<S> const& t, moving_sphere<S> const& s, S time) {
  if (time == 0) return contact_between(t, static_cast<sphere<S> const&>(s));
  local_sweep<double> const l = normalised(relative<double>(t, s), t, s);
  auto const at = static_cast<double>(time);
  auto const clear = [](double distance, double) { return sizeof(S) == sizeof(float) && distance >= clear_length; };
  auto const exactly = [t, s, time] {
    return exact_triangle<path_parts<S>>(t, s, exact_path<S>(s.displacement, decoded(time)).to);
  };
  vec3<double> const centre =
      s.centre.template cast<double>() + scaled<double>(s.displacement.template cast<double>(), at);
  return contact_from(seen_at(l, at), centre, s.radius, clear, exactly);
}

}  // namespace collide::detail
