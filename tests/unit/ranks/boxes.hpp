/// \file
/// Boxes, for the tests of where triangles and spheres go.
#pragma once

#include <collide/exact/detail/geometry/aabb.hpp>

namespace tests {

/// The cube around a point that reaches so far on each axis.
inline collide::detail::aabb<double> box_at(double x, double y, double z, double half) {
  auto box = collide::detail::aabb<double>::empty();
  double const at[] = {x, y, z};
  for (int k = 0; k < 3; ++k) box.lower[k] = at[k] - half, box.upper[k] = at[k] + half;
  return box;
}

inline bool overlap(collide::detail::aabb<double> const& a, collide::detail::aabb<double> const& b) {
  for (int k = 0; k < 3; ++k) {
    if (a.lower[k] > b.upper[k] || b.lower[k] > a.upper[k]) return false;
  }
  return true;
}

}  // namespace tests
