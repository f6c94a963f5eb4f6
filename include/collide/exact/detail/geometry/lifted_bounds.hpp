/// \file
/// Lifted bounding spheres: an overlap test as one scalar product in five dimensions (the lifting map).
///
/// |c - b| <= r + s holds if and only if c.b + r s + (s^2 - b^2) / 2 >= (c^2 - r^2) / 2. Terms of one sphere alone
/// are computed once; the rest is a scalar product in five dimensions. Coordinates are taken relative to a common
/// origin next to the mesh. Where squares cancel, rounding shows: it is covered by a part of the squares themselves, so
/// that a sphere far from the origin overlaps a bit too much, but never too little. Derivation in
/// docs/development/numerics.md.
#pragma once

#include <collide/exact/detail/geometry/bounding_sphere.hpp>
#include <collide/exact/detail/geometry/sphere_pack.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

/// How far computed squares may be off, as a part of them.
template <class S>
// guard: lifted-slack
inline constexpr S lifted_slack = 32 * ieee_traits<S>::unit_roundoff;

/// How far a radius may be off so that the coarsest narrow phase, which computes in float, loses nothing; see
/// `bounding_sphere::slack`.
template <class S>
inline constexpr S lifted_radius_slack = 32 * S(ieee_traits<float>::unit_roundoff);

/// The largest square that is computed with: a sphere beyond it is taken to overlap everything.
template <class S>
inline constexpr S max_lifted_square = std::numeric_limits<S>::max() / 16;

/// The bounding sphere of a triangle.
template <class S>
struct alignas(4 * sizeof(S)) lifted_bounds {
  S x, y, z, radius;  ///< relative to the origin
  S height;           ///< (radius^2 - centre^2) / 2, rounded up

  lifted_bounds() = default;

  /// The lifted form of `b`. Of an invalid triangle, nothing overlaps it but spheres that overlap everything.
  COLLIDE_HD_INLINE lifted_bounds(bounding_sphere<S> const& b, vec3<S> const& origin)
      : x{b.x - origin.x()}, y{b.y - origin.y()}, z{b.z - origin.z()}, radius{b.radius} {
    S const centre = x * x + y * y + z * z, square = radius * radius;
    height = (square - centre) / 2 + lifted_slack<S> * (centre + square) + lifted_radius_slack<S> * square +
             32 * std::numeric_limits<S>::min();
    bool const valid = is_valid_radius(radius);
    // guard: lifted-overflow
    if (is_finite(centre + square) && centre + square <= max_lifted_square<S>) return;
    x = y = z = radius = 0;
    height = valid ? std::numeric_limits<S>::max() / 2 : -std::numeric_limits<S>::max() / 2;
  }
};

/// The point that coordinates are relative to: a corner of the mesh, read and not computed, so that it is the same in
/// all kernels.
template <class S>
COLLIDE_HD_INLINE vec3<S> lifted_origin(mesh_view<S> const& mesh) {
  vec3<S> const corner = mesh[0].a;
  return is_finite(corner) ? corner : vec3<S>(0, 0, 0);
}

/// Consecutive spheres in lifted form; of moving spheres, their swept bounding spheres.
template <class S, int Items>
struct lifted_batch {
  S x[std::size_t(Items)], y[std::size_t(Items)], z[std::size_t(Items)], radius[std::size_t(Items)];
  S threshold[std::size_t(Items)];  ///< (centre^2 - radius^2) / 2, rounded down

  template <class Spheres>
  COLLIDE_HD_INLINE void load(Spheres const& spheres, std::size_t first, vec3<S> const& origin) {
    sphere_pack<S, unsigned(Items)> batch;
    batch.load(spheres, first);
    for (int k = 0; k < Items; ++k) {
      x[k] = batch.x[k] - origin.x();
      y[k] = batch.y[k] - origin.y();
      z[k] = batch.z[k] - origin.z();
      radius[k] = batch.radius[k];
      S const centre = x[k] * x[k] + y[k] * y[k] + z[k] * z[k], square = radius[k] * radius[k];
      threshold[k] = (centre - square) / 2 - lifted_slack<S> * (centre + square) - lifted_radius_slack<S> * square -
                     32 * std::numeric_limits<S>::min();
      // guard: lifted-sphere
      if (is_finite(centre + square) && centre + square <= max_lifted_square<S> && is_valid_radius(radius[k])) continue;
      x[k] = y[k] = z[k] = radius[k] = 0;
      // an invalid sphere overlaps nothing, one that is too large everything
      bool const none = !is_valid_radius(batch.radius[k]) || !is_finite(vec3<S>(batch.x[k], batch.y[k], batch.z[k]));
      threshold[k] = none ? std::numeric_limits<S>::max() : -std::numeric_limits<S>::max();
    }
  }

  /// True if any of the spheres may overlap the bounding sphere. Without branches: few do.
  COLLIDE_HD_INLINE bool any_overlaps(lifted_bounds<S> const& b) const {
    using flag = std::conditional_t<(Items > 4), uint_for<S>, bool>;  // of many: as wide as a lane of the vector unit
    flag some = 0;
    for (int k = 0; k < Items; ++k) {
      S const height = mul_add(radius[k], b.radius, b.height);
      S const sum = mul_add(x[k], b.x, mul_add(y[k], b.y, mul_add(z[k], b.z, height)));
      some |= static_cast<flag>(sum >= threshold[k]);
    }
    return some != 0;
  }
};

}  // namespace collide::detail
