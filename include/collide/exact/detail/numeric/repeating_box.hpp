/// \file
/// Coordinates in a box that repeats.
#pragma once

#include <cmath>

#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// A coordinate moved by a whole number of lengths, so that it is in [low, high).
template <class S>
COLLIDE_HD S wrapped(S x, S low, S high) {
  double const from = static_cast<double>(low), length = static_cast<double>(high) - from;
  double at = static_cast<double>(x), lengths;
  do {  // more than once if the number of lengths is not exact
    lengths = std::floor(div_rn(at - from, length));
    at = fma_rn(-lengths, length, at);
  } while (lengths > 0x1p51 || lengths < -0x1p51);
  S const inside = max(static_cast<S>(at), low);
  return inside >= high ? next_below(high) : inside;
}

/// A box that repeats along all three axes: a point is also a length away from where it is.
template <class S>
struct repeating_box {
  static constexpr int images = 27;  ///< where a point is next to the box, and in it

  S lower[3], upper[3];

  COLLIDE_HD_INLINE double length(int axis) const {
    return static_cast<double>(upper[axis]) - static_cast<double>(lower[axis]);
  }

  /// A point moved into the box. One that is not finite stays.
  COLLIDE_HD_INLINE vec3<S> inside(vec3<S> x) const {
    if (!is_finite(x)) return x;
    for (int k = 0; k < 3; ++k) {
      if (x[k] < lower[k] || x[k] >= upper[k]) x[k] = wrapped(x[k], lower[k], upper[k]);
    }
    return x;
  }

  /// Moves along each axis the upper one of two points in the box down by a length, if they are nearer to each other
  /// then. Whichever is named first, each comes to the same place: so both of a pair see the same.
  COLLIDE_HD_INLINE void bring_together(vec3<S>& a, vec3<S>& b) const {
    for (int k = 0; k < 3; ++k) {
      double const apart = 2 * (static_cast<double>(a[k]) - static_cast<double>(b[k]));
      if (apart > length(k)) a[k] = image(a[k], k, -1);
      if (-apart > length(k)) b[k] = image(b[k], k, -1);
    }
  }

  /// How many lengths along an axis one of the images of the box is away: 0, 1 or -1. Number 0 is the box.
  static COLLIDE_HD_INLINE int lengths_of(int number, int axis) {
    int const digit = axis == 0 ? number % 3 : axis == 1 ? number / 3 % 3 : number / 9;
    return digit == 2 ? -1 : digit;
  }
  /// A point of the box, moved into one of its images.
  COLLIDE_HD_INLINE vec3<S> in_image(vec3<S> x, int number) const {
    for (int k = 0; k < 3; ++k) {
      if (lengths_of(number, k) != 0) x[k] = image(x[k], k, lengths_of(number, k));
    }
    return x;
  }
  /// True if a point of the box is nearer than `reach` to the box in one of the images, too.
  COLLIDE_HD_INLINE bool is_near_in(vec3<S> const& x, int number, S reach) const {
    for (int k = 0; k < 3; ++k) {
      int const lengths = lengths_of(number, k);
      if ((lengths > 0 && x[k] - lower[k] > reach) || (lengths < 0 && upper[k] - x[k] > reach)) return false;
    }
    return true;
  }

  bool operator==(repeating_box const& other) const {
    bool same = true;
    for (int k = 0; k < 3; ++k) same = same && lower[k] == other.lower[k] && upper[k] == other.upper[k];
    return same;
  }

 private:
  COLLIDE_HD_INLINE S image(S x, int axis, int lengths) const {
    return static_cast<S>(static_cast<double>(x) + static_cast<double>(lengths) * length(axis));
  }
};

/// All of space, where nothing repeats.
struct open_space {
  bool operator==(open_space) const { return true; }
};

}  // namespace collide::detail
