/// \file
/// The ball that contains all of a sphere within a step.
#pragma once

#include <collide/detail/geometry/closest_point.hpp>

namespace collide::detail {

/// A ball around all of the way; see docs/numerics.md.
template <class S>
COLLIDE_HD_INLINE sphere<S> enclosing(moving_sphere<S> const& s) {
  vec3<S> const half = scaled(s.displacement, S(0.5));
  S const length = root(dot(half, half)) * (1 + 32 * S(format<float>::unit)) + 2 * root(std::numeric_limits<S>::min());
  S const slack = 8 * format<S>::unit * (magnitude(s.centre) + magnitude(s.displacement));
  return {s.centre + half, s.radius + (length + slack)};
}

/// A ball that the sphere contains in the middle of its way, if it is large enough for a certain hit; of a negative
/// radius if rounding leaves none. See docs/numerics.md.
template <class S>
COLLIDE_HD_INLINE sphere<S> midway(moving_sphere<S> const& s) {
  S const slack = 8 * format<S>::unit * (magnitude(s.centre) + magnitude(s.displacement));
  return {s.centre + scaled(s.displacement, S(0.5)), (s.radius - slack) * (1 - 4 * format<S>::unit)};
}

/// A sphere that rests is its own.
template <class S>
COLLIDE_HD_INLINE sphere<S> const& enclosing(sphere<S> const& s) {
  return s;
}

}  // namespace collide::detail
