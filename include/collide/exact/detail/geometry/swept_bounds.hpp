/// \file
/// Spheres that contain, or are contained in, a moving sphere's swept volume.
#pragma once

#include <collide/exact/detail/geometry/closest_point.hpp>

namespace collide::detail {

/// A sphere that contains the moving sphere at all times of the step, in real arithmetic. Proof:
/// docs/development/numerics.md.
template <class S>
COLLIDE_HD_INLINE sphere<S> swept_bounding_sphere(moving_sphere<S> const& s) {
  vec3<S> const half = scaled(s.displacement, S(0.5));
  S const length = sqrt_rn(dot(half, half)) * (1 + 32 * S(ieee_traits<float>::unit_roundoff)) +
                   2 * sqrt_rn(std::numeric_limits<S>::min());
  S const slack = 8 * ieee_traits<S>::unit_roundoff * (max_norm(s.centre) + max_norm(s.displacement));
  return {s.centre + half, (s.radius + (length + slack)) * (1 + 4 * ieee_traits<S>::unit_roundoff)};
}

/// A sphere inside the moving sphere at time 1/2; its radius is negative if rounding leaves none. Proof:
/// docs/development/numerics.md.
template <class S>
COLLIDE_HD_INLINE sphere<S> midpoint_sphere(moving_sphere<S> const& s) {
  S const slack = 8 * ieee_traits<S>::unit_roundoff * (max_norm(s.centre) + max_norm(s.displacement));
  return {s.centre + scaled(s.displacement, S(0.5)), (s.radius - slack) * (1 - 4 * ieee_traits<S>::unit_roundoff)};
}

/// The bounding sphere of a sphere at rest: itself.
template <class S>
COLLIDE_HD_INLINE sphere<S> const& swept_bounding_sphere(sphere<S> const& s) {
  return s;
}

}  // namespace collide::detail
