/// \file
/// Axis-aligned bounding boxes, and the overlap test of a triangle's box and a sphere.
#pragma once

#include <limits>

#include <collide/detail/numeric/float_bits.hpp>
#include <collide/detail/numeric/rounding.hpp>

namespace collide::detail {

/// An axis-aligned box, empty if lower > upper.
template <class S>
struct box {
  S lower[3], upper[3];

  static COLLIDE_HD box empty() {
    constexpr S far = std::numeric_limits<S>::infinity();
    return {{far, far, far}, {-far, -far, -far}};
  }

  COLLIDE_HD void extend(vec3<S> const& p) {
    for (int k = 0; k < 3; ++k) {
      lower[k] = smaller(lower[k], p[k]);
      upper[k] = larger(upper[k], p[k]);
    }
  }

  /// True of the box of nothing, and of that of a triangle that is not finite.
  COLLIDE_HD_INLINE bool is_empty() const { return !(lower[0] <= upper[0]); }

  /// The largest side; +infinity if it overflows.
  COLLIDE_HD_INLINE S extent() const {
    return larger(larger(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
  }

  struct unite {
    COLLIDE_HD box operator()(box const& a, box const& b) const {
      box c;
      for (int k = 0; k < 3; ++k) {
        c.lower[k] = smaller(a.lower[k], b.lower[k]);
        c.upper[k] = larger(a.upper[k], b.upper[k]);
      }
      return c;
    }
  };
};

/// The box of a triangle; empty if the triangle is not finite.
template <class S>
COLLIDE_HD_INLINE box<S> box_of(triangle<S> const& t) {
  constexpr S far = std::numeric_limits<S>::max();
  if (!finite(t)) return {{far, far, far}, {-far, -far, -far}};
  vec3<S> const lower = smaller(smaller(t.a, t.b), t.c), upper = larger(larger(t.a, t.b), t.c);
  return {{lower.x(), lower.y(), lower.z()}, {upper.x(), upper.y(), upper.z()}};
}

/// The box of a triangle, and the cheap test before the narrow phase: whether a ball comes near it.
template <class S>
struct alignas(4 * sizeof(S)) triangle_box : box<S> {
  S slack;  ///< room for the rounding of the coarsest narrow phase, as far as it goes with the triangle

  /// How far from the box the centre of a ball that touches the triangle is at most, `slack` apart; the root of the
  /// smallest normal number covers squares that underflow. See docs/numerics.md.
  static COLLIDE_HD_INLINE S reach(S radius) {
    return radius * (1 + 16 * S(format<float>::unit)) + 2 * root(std::numeric_limits<S>::min());
  }

  COLLIDE_HD_INLINE bool reached(vec3<S> const& c, S radius) const {
    S const x = gap(0, c.x()), y = gap(1, c.y()), z = gap(2, c.z()), most = reach(radius) + slack;
    return x * x + (y * y + z * z) <= most * most;
  }

  /// How far a coordinate is outside the box along an axis.
  COLLIDE_HD_INLINE S gap(int axis, S x) const {
    S const outside = larger(this->lower[axis] - x, x - this->upper[axis]);
    return select(outside > 0, outside, S(0));
  }
};

template <class S>
COLLIDE_HD_INLINE triangle_box<S> triangle_box_of(triangle<S> const& t) {
  box<S> const b = box_of(t);
  return {b, 16 * S(format<float>::unit) * b.extent()};
}

}  // namespace collide::detail
