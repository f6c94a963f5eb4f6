/// \file
/// Scenes on hilly ground.
#pragma once

#include <cstddef>
#include <cstdint>

#include "surfaces.hpp"

namespace io {

/// Hilly ground, and spheres in the air just above and below it.
inline scene terrain_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 1;
  add_hills(s, triangles);
  random_numbers random(seed);
  for (std::size_t i = 0; i < spheres; ++i) {
    double const x = random.between(-500, 500), y = random.between(-500, 500);
    add_point(s.centres, {x, y, hills(x, y) + random.between(-5, 45)});
  }
  return s;
}

/// Hilly ground, and grains that lie on it, 2 to 10 % of their radius deep.
inline scene grains_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 0.5;
  add_hills(s, triangles);
  random_numbers random(seed + 9);
  for (std::size_t i = 0; i < spheres; ++i) {
    double const x = random.between(-499, 499), y = random.between(-499, 499), e = 1e-4;
    double const falls_x = (hills(x - e, y) - hills(x + e, y)) / (2 * e);
    double const falls_y = (hills(x, y - e) - hills(x, y + e)) / (2 * e);
    double const height = s.radius - random.between(0.01, 0.05);
    add_point(s.centres, point{x, y, hills(x, y)} + height * normalized({falls_x, falls_y, 1}));
  }
  return s;
}

}  // namespace io
