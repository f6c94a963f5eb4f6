/// \file
/// How far spheres and triangles are apart: of how many pairs a grid with cells of some width makes candidates.
#pragma once

#include <cstdint>

#include <collide/core/moving_spheres.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// The sphere at a part of its path, from 0 to 1, if it moves.
template <class S>
COLLIDE_HD_INLINE sphere<S> sphere_on_path(sphere<S> const& s, S) {
  return s;
}
template <class S>
COLLIDE_HD_INLINE sphere<S> sphere_on_path(moving_sphere<S> const& s, S time) {
  return {s.centre + time * s.displacement, s.radius};
}

/// How far a sphere moves along the axis on which it moves farthest.
template <class S>
COLLIDE_HD_INLINE S path_of(sphere<S> const&) {
  return 0;
}
template <class S>
COLLIDE_HD_INLINE S path_of(moving_sphere<S> const& s) {
  S largest = 0;
  for (int k = 0; k < 3; ++k) largest = max(largest, max(s.displacement[k], -s.displacement[k]));
  return largest;
}

/// The space near the longest edge of a triangle that is long and thin and lies across the axes: it fills no more of
/// its box. Memory of a block, not constructed.
template <class S>
struct thin_part {
  S across[3], normal[3];  ///< directions across the edge, in the triangle's plane and out of it
  S on_across, on_normal;  ///< where the edge is on these
  S height;                ///< of the triangle, along `across`
  bool is_thin;            ///< false if the triangle fills its box: of what else there is nothing set then

  static COLLIDE_HD_INLINE thin_part of(triangle<S> const& t) {
    vec3<S> const ends[3] = {t.a, t.b, t.c};
    int first = 0;
    S squares[3];
    for (int k = 0; k < 3; ++k) {
      vec3<S> const edge = ends[(k + 1) % 3] - ends[k];
      squares[k] = dot<S>(edge, edge);
      first = squares[k] > squares[first] ? k : first;
    }
    vec3<S> const along = ends[(first + 1) % 3] - ends[first], aside = ends[(first + 2) % 3] - ends[first];
    vec3<S> normal = cross<S>(along, aside);
    aabb<S> const b = triangle_aabb_of(t);
    S const twice_area = sqrt_rn(dot<S>(normal, normal)), x = b.upper[0] - b.lower[0], y = b.upper[1] - b.lower[1],
            z = b.upper[2] - b.lower[2];
    thin_part part{};
    if (!(squares[first] > 0) || !is_finite(squares[first]) || !(x * y + (y * z + z * x) > 8 * twice_area)) return part;
    if (!(twice_area > 0)) {  // any direction across: by the axis along which the edge is the shortest
      int axis = 0;
      for (int k = 1; k < 3; ++k) axis = along[k] * along[k] < along[axis] * along[axis] ? k : axis;
      normal = cross<S>(along, vec3<S>(S(axis == 0), S(axis == 1), S(axis == 2)));
    }
    vec3<S> const across = cross<S>(normal, along);
    S const to_unit_normal = S(1) / sqrt_rn(dot<S>(normal, normal)),
            to_unit_across = S(1) / sqrt_rn(dot<S>(across, across));
    part.is_thin = is_finite(to_unit_normal) && is_finite(to_unit_across);
    for (int k = 0; k < 3; ++k) {
      part.normal[k] = normal[k] * to_unit_normal;
      part.across[k] = across[k] * to_unit_across;
      part.on_normal += ends[first][k] * part.normal[k];
      part.on_across += ends[first][k] * part.across[k];
    }
    part.height = twice_area / sqrt_rn(squares[first]);
    return part;
  }

  /// How far a point is from it, on the direction on which it is farther; 0 if the triangle fills its box.
  COLLIDE_HD_INLINE S distance(vec3<S> const& p) const {
    if (!is_thin) return 0;
    S h = -on_across, n = -on_normal;
    for (int k = 0; k < 3; ++k) {
      h += p[k] * across[k];
      n += p[k] * normal[k];
    }
    return max(max(n, -n), max(-h, h - height));
  }
};

/// The distances, on the axis where they are farther apart, of sampled spheres from the boxes of sampled triangles, in
/// units of the grid's extent: a histogram over octaves. Memory of a block, not constructed.
struct pair_distances {
  static constexpr std::uint32_t spheres = 64, triangles = 64, bins = 32;

  std::uint32_t counts[bins];
  std::uint32_t sampled;  ///< spheres
  std::uint32_t path;     ///< of all of them, at most 1 for each, in units of path_unit
  std::uint32_t thin;     ///< triangles that fill a small part of their box

  static constexpr float path_unit = 0x1p-16f;

  /// How far a sphere moves, on average.
  COLLIDE_HD_INLINE float mean_path() const {
    return sampled != 0 ? static_cast<float>(path) * path_unit / static_cast<float>(sampled) : 0.f;
  }

  /// The share of triangles that fill their boxes.
  COLLIDE_HD_INLINE float full() const { return 1 - static_cast<float>(thin) / triangles; }

  /// Bin k is of distances below 2^(k - 28); those of 8 and more are in the last.
  COLLIDE_HD_INLINE static std::uint32_t bin_of(float distance) {
    std::uint32_t const octave = to_bits(distance) >> 23;
    return min(max(octave, 127u - 29) - (127u - 29), bins - 1);
  }
  COLLIDE_HD_INLINE static float end_of(std::uint32_t bin) { return from_bits<float>((bin + 127 - 28) << 23); }
};

/// The share of all pairs that are not farther apart than a distance, estimated from a few thousand pairs: a power of
/// the distance where there are few.
class share_of_pairs {
 public:
  COLLIDE_HD explicit share_of_pairs(pair_distances const& seen) : full_{seen.full()} {
    constexpr std::uint32_t few = 12;
    std::uint32_t const all = seen.sampled * pair_distances::triangles;
    std::uint32_t below = 0, bin = 0, sum = 0, farther = 0;
    for (std::uint32_t k = 0; k < pair_distances::bins; ++k) {
      if (sum < few) bin = k;
      sum += seen.counts[k];
      if (bin == k) below = sum;
      if (k <= bin + 2) farther = sum;
    }
    distance_ = pair_distances::end_of(bin);
    if (all == 0 || below == 0) return;
    share_ = static_cast<float>(below) / static_cast<float>(all);
    // by what power the share grows: 3 where spheres fill a volume, 2 where they lie on the surface
    power_ = 0.5f * log2f(static_cast<float>(farther) / static_cast<float>(below));
    power_ = min(max(power_, 1.f), 3.f);
  }

  /// The share of triangles that fill their boxes.
  COLLIDE_HD_INLINE float full() const { return full_; }

  /// The share for triangles with this mean extent.
  COLLIDE_HD float operator()(float distance, float extent) const {
    float const own = full_ * extent, x = (own + 2 * distance) / (own + 2 * distance_);
    return x > 0 ? min(1.f, share_ * exp2f(power_ * log2f(x))) : 0.f;
  }

 private:
  float distance_ = 1, share_ = 0, power_ = 3, full_;
};

}  // namespace collide::detail
