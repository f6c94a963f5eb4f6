/// \file
/// Karabassi's swept test in plain arithmetic.
#pragma once

#include <collide/exact/detail/predicates/filter_swept.hpp>
#include <collide/narrow/detail/karabassi_test.hpp>

namespace collide::detail {

/// The swept test in coordinates local to the start of the path and scaled by a power of two. A hit is reported only
/// for a point of the triangle and a point of the path that were found within the radius of each other.
template <class T, class S>
COLLIDE_HD_INLINE bool karabassi_swept_local(triangle<S> const& of, moving_sphere<S> const& s) {
  using W = std::common_type_t<S, T>;
  local_sweep<W> const l = to_local<W>(of, s);
  if (!aabb_within(l, l.shape.radius + swept_error<W> * max_norm(l))) return false;
  if (!is_valid_radius(s.radius) || !is_finite(s.centre) || !is_finite(s.displacement) || !is_finite(of)) return false;
  if (is_infinite(s.radius)) return true;
  if (max_norm(s.displacement) < std::numeric_limits<S>::min()) {
    return karabassi_local<T>(of, static_cast<sphere<S> const&>(s));
  }
  local_sweep<T> const t = narrow_to<T>(to_unit_range(l, of, s));
  return approach(t).distance_squared <= mul_rn(t.shape.radius, t.shape.radius);
}

}  // namespace collide::detail
