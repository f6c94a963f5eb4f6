/// \file
/// Karabassi's swept test in plain arithmetic.
#pragma once

#include <collide/detail/narrow_phase/karabassi_test.hpp>
#include <collide/detail/predicates/filter_swept.hpp>

namespace collide::detail {

/// The swept test in coordinates local to the start of the path and scaled by a power of two. A hit is reported only
/// for a point of the triangle and a point of the path that were found within the radius of each other.
template <class T, class S>
COLLIDE_HD_INLINE bool swept_in_reach(triangle<S> const& of, moving_sphere<S> const& s) {
  using W = std::common_type_t<S, T>;
  local_sweep<W> const l = relative<W>(of, s);
  if (!box_in_reach(l, l.shape.radius + sweep_error<W> * size_of(l))) return false;
  if (!valid_radius(s.radius) || !finite(s.centre) || !finite(s.displacement) || !finite(of)) return false;
  if (infinite(s.radius)) return true;
  if (magnitude(s.displacement) < std::numeric_limits<S>::min()) {
    return local_four_steps<T>(of, static_cast<sphere<S> const&>(s));
  }
  local_sweep<T> const t = rounded<T>(normalised(l, of, s));
  return approach(t).distance_squared <= mul(t.shape.radius, t.shape.radius);
}

}  // namespace collide::detail
