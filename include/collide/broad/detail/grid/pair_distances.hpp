/// \file
/// How far spheres and triangles are apart: of how many pairs a grid with cells of some width makes candidates.
#pragma once

#include <cmath>
#include <cstddef>
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
  S most = 0;
  for (int k = 0; k < 3; ++k) most = max(most, max(s.displacement[k], -s.displacement[k]));
  return most;
}

/// The distances, on the axis where they are farther apart, of sampled spheres from the boxes of sampled triangles, in
/// units of the grid's extent: a histogram over octaves. Memory of a block, not constructed.
struct pair_distances {
  static constexpr std::uint32_t spheres = 64, triangles = 64, bins = 32;

  std::uint32_t counts[bins];
  std::uint32_t sampled;  ///< spheres
  std::uint32_t path;     ///< of all of them, at most 1 for each, in units of path_unit

  static constexpr float path_unit = 0x1p-16f;

  /// How far a sphere moves, on average.
  COLLIDE_HD_INLINE float mean_path() const {
    return sampled != 0 ? static_cast<float>(path) * path_unit / static_cast<float>(sampled) : 0.f;
  }

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
  COLLIDE_HD explicit share_of_pairs(pair_distances const& seen) {
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

  /// The share for triangles with this mean extent.
  COLLIDE_HD float operator()(float distance, float extent) const {
    float const x = (extent + 2 * distance) / (extent + 2 * distance_);
    return x > 0 ? min(1.f, share_ * exp2f(power_ * log2f(x))) : 0.f;
  }

 private:
  float distance_ = 1, share_ = 0, power_ = 3;
};

}  // namespace collide::detail
