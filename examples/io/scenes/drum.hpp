/// \file
/// A drum that is half full of packed spheres.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "surfaces.hpp"

namespace io {

namespace detail {

/// A closed cylinder around the y axis, as long as its radius `wall`. Its triangles are long: its jacket has about a
/// hundred times as many quadrangles around as along, and its caps are fans around their middles.
inline void add_drum(scene& s, double wall, std::size_t triangles) {
  double const half_of_them = static_cast<double>(triangles) / 2;
  auto const around = static_cast<std::size_t>(std::max(3.0, std::round(10 * std::sqrt(half_of_them))));
  auto const rings = static_cast<std::size_t>(std::max(2.0, std::round(half_of_them / static_cast<double>(around))));
  double const half = wall / 2;
  auto const first = add_tube(s, around, rings, [&](std::size_t k, double u) {
    double const y = 2 * half * (static_cast<double>(k) / static_cast<double>(rings - 1) - 0.5);
    return point{wall * std::cos(u), y, wall * std::sin(u)};
  });
  auto const middles = static_cast<std::uint32_t>(s.vertices.size() / 3);
  add_point(s.vertices, {0, -half, 0});
  add_fan(s, middles, first, around, true);
  add_point(s.vertices, {0, half, 0});
  add_fan(s, middles + 1, static_cast<std::uint32_t>(first + (rings - 1) * around), around, false);
}

/// Moves a sphere that is next to the drum's walls, so that it overlaps them by 1 to 3 % of its radius, 1. Returns
/// false if there is no room for it.
inline bool settle(point& p, double wall, random_numbers& random) {
  double const half = wall / 2, gap = wall - std::hypot(p[0], p[2]), left = p[1] + half, right = half - p[1];
  if (gap < 0.5 || left < 0.5 || right < 0.5) return false;
  double const rest = 0.97 + 0.02 * random.unit();
  if (left < 1.5) p[1] = rest - half;
  if (right < 1.5) p[1] = half - rest;
  if (gap < 1.5) {
    double const t = (wall - rest) / std::hypot(p[0], p[2]);
    p[0] *= t;
    p[2] *= t;
  }
  return true;
}

}  // namespace detail

/// A drum half full of spheres of radius 1: a hexagonal packing, each a bit out of its place, in the order of the
/// lattice from the bottom up. Those next to the walls overlap them by 1 to 3 %.
inline scene drum_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  double const apart = 2.02, layer = apart * std::sqrt(2.0 / 3), row = apart * std::sqrt(3.0) / 2;
  double const density = std::sqrt(2.0) / (apart * apart * apart);
  double const wall = std::cbrt(static_cast<double>(spheres) / density / (pi / 2)) + 0.7;
  scene s;
  s.radius = 1;
  detail::add_drum(s, wall, triangles);
  random_numbers random(seed + 7);
  auto const reach = static_cast<int>(wall / row) + 2;
  for (int k = 0; k * layer < 2 * wall; ++k) {
    for (int j = -reach; j <= reach; ++j) {
      double const y = j * row + k % 2 * apart / std::sqrt(12.0), z = -wall + 1 + k * layer;
      for (int i = -reach; i <= reach; ++i) {
        if (s.sphere_count() == spheres) return s;
        double const x = (i + 0.5 * ((j & 1) + (k & 1))) * apart;
        if (std::abs(x) > wall + 1 || std::abs(y) > wall / 2 + 1) continue;
        point p = random.in_cube(0.01, {x, y, z});
        if (detail::settle(p, wall, random)) add_point(s.centres, p);
      }
    }
  }
  return s;
}

}  // namespace io
