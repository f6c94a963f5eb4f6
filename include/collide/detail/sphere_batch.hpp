/// \file
/// The spheres that a lane works on.
#pragma once

#include <collide/detail/arithmetic.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// `Items` consecutive spheres, in registers on CUDA. Spheres beyond the end, and spheres that can touch nothing because
/// their radius is negative or NaN, have a NaN radius.
template <class S, int Items>
struct sphere_batch {
  static_assert(Items % 4 == 0, "centres are loaded four at a time");

  vec3<S> centre[Items];
  S radius[Items];

  COLLIDE_HD_INLINE void load(sphere_view<S> const& spheres, std::size_t first) {
    std::size_t const n = spheres.size();
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
    for (int k = 0; k < Items; k += 4) {
      std::size_t const i = first + static_cast<std::size_t>(k);
      vec3<S> four[4];
      if (i + 4 <= n) {
        spheres.four_centres(i, four);
      } else {
        for (std::size_t j = 0; j < 4; ++j) four[j] = i + j < n ? spheres.centre(i + j) : vec3<S>{0, 0, 0};
      }
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
      for (std::size_t j = 0; j < 4; ++j) {
        S const r = i + j < n ? spheres.radius(i + j) : S(-1);
        centre[static_cast<std::size_t>(k) + j] = four[j];
        radius[static_cast<std::size_t>(k) + j] = valid_radius(r) ? r : std::numeric_limits<S>::quiet_NaN();
      }
    }
  }
};

}  // namespace collide::detail
