/// \file
/// Axis-aligned bounding boxes, and the overlap test of a triangle's box and a sphere.
#pragma once

#include <limits>

#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// An axis-aligned box, empty if lower > upper.
template <class S>
struct aabb {
  S lower[3], upper[3];

  static COLLIDE_HD aabb empty() {
    constexpr S far = std::numeric_limits<S>::infinity();
    return {{far, far, far}, {-far, -far, -far}};
  }

  /// True of the box of nothing, and of that of a triangle that is not finite.
  COLLIDE_HD_INLINE bool is_empty() const { return !(lower[0] <= upper[0]); }

  /// The largest side; +infinity if it overflows.
  COLLIDE_HD_INLINE S max_extent() const {
    return max(max(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
  }

  struct merge {
    COLLIDE_HD aabb operator()(aabb const& a, aabb const& b) const {
      aabb c;
      COLLIDE_UNROLL
      for (int k = 0; k < 3; ++k) {
        c.lower[k] = min(a.lower[k], b.lower[k]);
        c.upper[k] = max(a.upper[k], b.upper[k]);
      }
      return c;
    }
  };
};

/// The box of a triangle; empty if the triangle is not finite.
template <class S>
COLLIDE_HD_INLINE aabb<S> aabb_of(triangle<S> const& t) {
  constexpr S far = std::numeric_limits<S>::max();
  if (!is_finite(t)) return {{far, far, far}, {-far, -far, -far}};
  vec3<S> const lower = min(min(t.a, t.b), t.c), upper = max(max(t.a, t.b), t.c);
  return {{lower.x(), lower.y(), lower.z()}, {upper.x(), upper.y(), upper.z()}};
}

/// The box of a triangle, and the cheap test before the narrow phase: whether a sphere comes near it.
template <class S>
struct alignas(4 * sizeof(S)) triangle_aabb : aabb<S> {
  S padding;  ///< room for the rounding of the coarsest narrow phase, as far as it goes with the triangle

  /// How far from the box the centre of a sphere that touches the triangle is at most, `padding` apart; the root of the
  /// smallest normal number covers squares that underflow. See docs/development/numerics.md.
  static COLLIDE_HD_INLINE S padded_radius(S radius) {
    return radius * (1 + 16 * S(ieee_traits<float>::unit_roundoff)) + 2 * sqrt_rn(std::numeric_limits<S>::min());
  }

  /// `padding` of a box whose largest side is this.
  static COLLIDE_HD_INLINE S padding_of(S extent) { return 16 * S(ieee_traits<float>::unit_roundoff) * extent; }

  COLLIDE_HD_INLINE bool overlaps(vec3<S> const& c, S radius) const {
    S const x = axis_distance(0, c.x()), y = axis_distance(1, c.y()), z = axis_distance(2, c.z()),
            limit = padded_radius(radius) + padding;
    return x * x + (y * y + z * z) <= limit * limit;
  }

  /// How far a coordinate is outside the box along an axis.
  COLLIDE_HD_INLINE S axis_distance(int axis, S x) const {
    S const outside = max(this->lower[axis] - x, x - this->upper[axis]);
    return select(outside > 0, outside, S(0));
  }
};

template <class S>
COLLIDE_HD_INLINE triangle_aabb<S> triangle_aabb_of(triangle<S> const& t) {
  aabb<S> const b = aabb_of(t);
  return {b, triangle_aabb<S>::padding_of(b.max_extent())};
}

}  // namespace collide::detail
