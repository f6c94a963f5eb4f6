/// \file
/// Scenes of one plain solid.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "surfaces.hpp"

namespace io {

/// A ball, and spheres around its surface: the triangles at its poles are degenerate.
inline scene ball_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 3;
  auto const [columns, rows] = grid_of(triangles, 2);
  add_surface(s, columns, rows, false, [](double across, double along) {
    double const u = 2 * pi * across, v = pi * along;
    return point{300 * std::sin(v) * std::cos(u), 300 * std::sin(v) * std::sin(u), 300 * std::cos(v)};
  });
  random_numbers random(seed);
  add_spheres(s, spheres, random, 350);
  return s;
}

/// The unit cube of 12 triangles, and four spheres of radius 0.4 of which two touch it.
inline scene cube_scene() {
  scene s;
  s.radius = 0.4;
  add_box(s, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5});
  s.centres = {0, 0, 0, 3, 3, 3, 0.5, 0.5, 0.5, 1.3, 0, 0.5};
  return s;
}

/// An octahedron, and two spheres of radius 20: the first touches the four lower faces, the second none.
inline scene octahedron_scene() {
  scene s;
  s.vertices = {0, 0, 78, 45, 45, 0, -45, 45, 0, -45, -45, 0, 45, -45, 0, 0, 0, -78};
  s.corners = {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1, 5, 2, 1, 5, 3, 2, 5, 4, 3, 5, 1, 4};
  s.centres = {0, 0, -90, 0, 0, 100};
  s.radius = 20;
  return s;
}

}  // namespace io
