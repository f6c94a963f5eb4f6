/// \file
/// Spheres that contain, or are contained in, a moving sphere's swept volume.
#pragma once

#include <collide/detail/geometry/closest_point.hpp>

namespace collide::detail {

/// A sphere that contains the moving sphere at all times of the step. Proof: docs/numerics.md.
template <class S>
COLLIDE_HD_INLINE sphere<S> enclosing(moving_sphere<S> const& s) {
  vec3<S> const half = scaled(s.displacement, S(0.5));
  S const length = root(dot(half, half)) * (1 + 32 * S(format<float>::unit)) + 2 * root(std::numeric_limits<S>::min());
  S const slack = 8 * format<S>::unit * (magnitude(s.centre) + magnitude(s.displacement));
  return {s.centre + half, s.radius + (length + slack)};
}

/// A sphere inside the moving sphere at time 1/2; its radius is negative if rounding leaves none. Proof:
/// docs/numerics.md.
template <class S>
COLLIDE_HD_INLINE sphere<S> midway(moving_sphere<S> const& s) {
  S const slack = 8 * format<S>::unit * (magnitude(s.centre) + magnitude(s.displacement));
  return {s.centre + scaled(s.displacement, S(0.5)), (s.radius - slack) * (1 - 4 * format<S>::unit)};
}

/// The bounding sphere of a sphere at rest: itself.
template <class S>
COLLIDE_HD_INLINE sphere<S> const& enclosing(sphere<S> const& s) {
  return s;
}

}  // namespace collide::detail
