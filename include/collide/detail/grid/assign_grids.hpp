/// \file
/// Which grid serves each of the few spheres that a lane works on.
#pragma once

#include <cstddef>

#include <collide/detail/geometry/sphere_pack.hpp>
#include <collide/detail/grid/grid_ref.hpp>

namespace collide::detail {

/// The spheres of a lane, and which grid serves each. Grids come by falling reach, so a sphere ends up in the
/// tightest.
template <class S, int Items, bool Still>
struct lane_state {
  static constexpr int nowhere = bucket_lookup<S>::nowhere, everywhere = bucket_lookup<S>::everywhere;

  sphere_batch<S, Items> batch;
  int grid_number[Items];

  COLLIDE_HD_INLINE void load(sphere_view<S> const& spheres, std::size_t first) {
    batch.load(spheres, first);
    for (int k = 0; k < Items; ++k) grid_number[k] = valid_radius(batch.radius[k]) ? everywhere : nowhere;
  }

  /// Places the spheres that grid `g` can serve. Without branches, for the CPU's vector unit.
  COLLIDE_HD_INLINE void place(grid<S> const& box, int g) {
    for (int k = 0; k < Items; ++k) {
      bool const inside = (batch.x[k] >= box.lower[0]) & (batch.x[k] <= box.upper[0]) & (batch.y[k] >= box.lower[1]) &
                          (batch.y[k] <= box.upper[1]) & (batch.z[k] >= box.lower[2]) & (batch.z[k] <= box.upper[2]);
      // a sphere that is nowhere stays there: its radius may be NaN, and comparisons with that are up to -ffast-math
      bool const served = (grid_number[k] != nowhere) & (batch.radius[k] <= box.reach);
      int const there = inside ? g : nowhere;
      grid_number[k] = served ? there : grid_number[k];
    }
  }
};

/// The same of spheres that move.
template <class S, int Items>
struct lane_state<S, Items, false> {
  static constexpr int nowhere = bucket_lookup<S>::nowhere, everywhere = bucket_lookup<S>::everywhere;

  moving_batch<S, Items> batch;
  int grid_number[Items];

  COLLIDE_HD_INLINE void load(moving_sphere_view<S> const& spheres, std::size_t first) {
    batch.load(spheres, first);
    for (int k = 0; k < Items; ++k) {
      bool const sound = valid_radius(batch.radius[k]) && finite(batch.centre(k)) && finite(batch.displacement(k));
      grid_number[k] = sound ? everywhere : nowhere;
    }
  }

  COLLIDE_HD_INLINE void place(grid<S> const& box, int g) {
    S const inverse_width = box.levels > 0 ? box.level[0].inverse_width : S(0);
    for (int k = 0; k < Items; ++k) {
      bool const inside = way<S>::enters(box.lower[0], box.upper[0], batch.x[k], batch.dx[k]) &&
                          way<S>::enters(box.lower[1], box.upper[1], batch.y[k], batch.dy[k]) &&
                          way<S>::enters(box.lower[2], box.upper[2], batch.z[k], batch.dz[k]);
      bool const walks = way<S>::can_walk(box.lower[0], box.upper[0], inverse_width, batch.x[k], batch.dx[k]) &&
                         way<S>::can_walk(box.lower[1], box.upper[1], inverse_width, batch.y[k], batch.dy[k]) &&
                         way<S>::can_walk(box.lower[2], box.upper[2], inverse_width, batch.z[k], batch.dz[k]);
      bool const served = grid_number[k] != nowhere && batch.radius[k] <= box.reach && walks;
      int const there = inside ? g : nowhere;
      grid_number[k] = served ? there : grid_number[k];
    }
  }
};

}  // namespace collide::detail
