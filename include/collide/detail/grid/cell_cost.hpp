/// \file
/// What cells of some width cost: the entries of triangles, and the candidates that spheres find.
#pragma once

#include <collide/detail/execution/tuning.hpp>
#include <collide/detail/grid/pair_distances.hpp>

namespace collide::detail {

/// Sums over triangles.
struct triangle_sums {
  float count, area, perimeter;

  COLLIDE_HD_INLINE triangle_sums& operator+=(triangle_sums const& o) {
    count += o.count, area += o.area, perimeter += o.perimeter;
    return *this;
  }

  /// About how many cells of this width the triangles meet when they are dilated by `reach`: the volume within a
  /// distance of a triangle (Steiner's formula), by that of a cell.
  COLLIDE_HD_INLINE float entries(float width, float reach) const {
    float const d = (reach + 0.7f * width) / width;
    return 2 * d * (area / (width * width)) + 1.5708f * d * d * (perimeter / width) + 4.1888f * d * d * d * count;
  }

  /// The mean extent of their boxes.
  COLLIDE_HD_INLINE float mean_extent() const { return count > 0 ? perimeter / (perimeter_of_extent * count) : 0.f; }

  /// The perimeter of a triangle whose box has an extent of 1: from 2 to 3.5.
  static constexpr float perimeter_of_extent = 2.4f;
};

/// What a level of cells costs, in nanoseconds.
struct level_cost {
  bucket_costs costs;
  float spheres;
  float reach;
  float path;  ///< how far a sphere moves
  share_of_pairs const& share;

  COLLIDE_HD_INLINE float operator()(triangle_sums const& t, float width) const {
    float const pairs = spheres * t.count * share(reach + 0.5f * width, t.mean_extent()), cells = path / width;
    return costs.entry_ns * t.entries(width, reach) + costs.candidate_ns * pairs * (1 + cells) +
           costs.step_ns * spheres * cells;
  }
};

}  // namespace collide::detail
