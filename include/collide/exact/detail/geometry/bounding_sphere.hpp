/// \file
/// Bounding spheres: of a triangle, the cheap test before the narrow phase, and of a moving sphere's swept volume.
#pragma once

#include <collide/exact/detail/geometry/closest_point.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// A sphere that contains a triangle; `radius` is NaN if the triangle is not finite, so that nothing overlaps it.
template <class S>
struct alignas(4 * sizeof(S)) bounding_sphere {
  S x, y, z, radius;

  /// Covers the rounding here and that of the coarsest narrow phase, which computes in float.
  // guard: slack
  static constexpr S slack = 1 + 32 * S(ieee_traits<float>::unit_roundoff);

  /// The squared distance within which a centre can reach the triangle with a sphere of radius `r`: rounded up so far
  /// that `distance_squared(c) <= squared_reach(r)` holds, in floating-point numbers, whenever |c - centre| <= radius +
  /// r in real ones. Derivation in docs/development/numerics.md; NaN for an invalid triangle.
  COLLIDE_HD_INLINE S squared_reach(S r) const {
    S const sum = radius + r;
    return sum * sum * slack;
  }

  COLLIDE_HD_INLINE S distance_squared(S cx, S cy, S cz) const {
    S const dx = cx - x, dy = cy - y, dz = cz - z;
    return dx * dx + dy * dy + dz * dz;
  }

  COLLIDE_HD_INLINE bool overlaps(vec3<S> const& c, S r) const {
    return distance_squared(c.x(), c.y(), c.z()) <= squared_reach(r);
  }
};

/// A bounding sphere around the centre of the triangle's box.
template <class S>
COLLIDE_HD_INLINE bounding_sphere<S> bounding_sphere_of(triangle<S> const& t) {
  if (!is_finite(t)) return {S(0), S(0), S(0), std::numeric_limits<S>::quiet_NaN()};
  vec3<S> const lower = min(min(t.a, t.b), t.c), upper = max(max(t.a, t.b), t.c);
  vec3<S> const m = lower * S(0.5) + upper * S(0.5);
  bounding_sphere<S> const at{m.x(), m.y(), m.z(), S(0)};
  S const far_squared =
      max(max(at.distance_squared(t.a.x(), t.a.y(), t.a.z()), at.distance_squared(t.b.x(), t.b.y(), t.b.z())),
          at.distance_squared(t.c.x(), t.c.y(), t.c.z()));
  // -ffast-math makes a NaN of the root of infinity
  if (!is_finite(far_squared)) return {m.x(), m.y(), m.z(), std::numeric_limits<S>::infinity()};
  // the root of the smallest normal number covers squares that underflow
  // guard: ball-underflow
  S const radius = sqrt_rn(far_squared) * bounding_sphere<S>::slack + 2 * sqrt_rn(std::numeric_limits<S>::min());
  return {m.x(), m.y(), m.z(), radius};
}

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
