/// \file
/// A triangle and the path of a moving sphere's centre, in coordinates local to the start of the path.
#pragma once

#include <collide/exact/detail/geometry/closest_point.hpp>

namespace collide::detail {

/// The centre moves from the origin along `path`.
template <class T>
struct local_sweep {
  local_triangle<T> shape;
  vec3<T> path;
};

/// Subtracts the centre. `W` holds all values of `S`.
template <class W, class S>
COLLIDE_HD_INLINE local_sweep<W> to_local(triangle<S> const& t, moving_sphere<S> const& s) {
  return {to_local<W>(t, static_cast<sphere<S> const&>(s)), cast_to<W>(s.displacement)};
}

/// The largest absolute value of all coordinates, the radius and the displacement.
template <class T>
COLLIDE_HD_INLINE T max_norm(local_sweep<T> const& l) {
  return max(max_norm(l.shape), max_norm(l.path));
}

/// The problem scaled by a power of two.
template <class T>
COLLIDE_HD_INLINE local_sweep<T> scaled(local_sweep<T> const& l, T s) {
  return {scaled(l.shape, s), scaled(l.path, s)};
}

/// `relative` scaled so that its largest number is below 4 and at least 1, unless all are tiny. Finite input only.
template <class W, class S>
COLLIDE_HD_INLINE local_sweep<W> to_unit_range(local_sweep<W> l, triangle<S> const& t, moving_sphere<S> const& s) {
  if constexpr (sizeof(W) == sizeof(S)) {
    if (!is_finite(max_norm(l))) {  // a difference was beyond the range
      constexpr W tiny = std::numeric_limits<W>::min();
      l = to_local<W>(triangle<S>{scaled(t.a, tiny), scaled(t.b, tiny), scaled(t.c, tiny)},
                      moving_sphere<S>{{scaled(s.centre, tiny), mul_rn(s.radius, tiny)}, scaled(s.displacement, tiny)});
      l.shape.scale = tiny;
    }
  }
  return scaled(l, inverse_power_of_two(max_norm(l)));
}

/// Rounds scaled local coordinates to `T`, whose range they fit.
template <class T, class W>
COLLIDE_HD_INLINE local_sweep<T> narrow_to(local_sweep<W> const& l) {
  return {narrow_to<T>(l.shape), cast_to<T>(l.path)};
}

/// False if, on some axis, the triangle's box is farther than `reach` from the whole path.
template <class T>
COLLIDE_HD_INLINE bool aabb_within(local_sweep<T> const& l, T reach) {
  vec3<T> const still = vec3<T>(T(0), T(0), T(0));
  vec3<T> const lower = min(min(l.shape.a, l.shape.b), l.shape.c) - max(l.path, still);
  vec3<T> const upper = max(max(l.shape.a, l.shape.b), l.shape.c) - min(l.path, still);
  return !(max_component<T>(lower) > reach || max_component<T>(-upper) > reach);
}

/// The triangle relative to the centre at a time of the step.
template <class T>
COLLIDE_HD_INLINE local_triangle<T> at_time(local_sweep<T> const& l, T time) {
  vec3<T> const gone = scaled(l.path, time);
  return {l.shape.a - gone, l.shape.b - gone, l.shape.c - gone, l.shape.radius, l.shape.scale};
}

}  // namespace collide::detail
