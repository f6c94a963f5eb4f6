/// \file
/// Scenes of triangles that are no surface, every way round.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "scene.hpp"

namespace io {

/// Triangles in a cube of 1000, their edges from 0.02 to 200, as many of each order of magnitude.
inline scene soup_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 1;
  random_numbers random(seed + 10);
  for (std::size_t i = 0; i < triangles; ++i) {
    double const size = 0.02 * std::pow(10000.0, random.unit());
    point const a = random.in_cube(500), along = random.in_cube(1), aside = random.in_cube(1);
    add_triangle(s, a, a + size * normalized(along), a + (size * random.between(0.5, 1)) * normalized(aside));
  }
  add_spheres(s, spheres, random, 500);
  return s;
}

/// Triangles half a thousand long and a thousandth wide.
inline scene slivers_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 3;
  random_numbers random(seed);
  for (std::size_t i = 0; i < triangles; ++i) {
    point const a = random.in_cube(300), along = random.in_cube(250), aside = random.in_cube(0.001);
    add_triangle(s, a, a + along, a + along + aside);
  }
  add_spheres(s, spheres, random, 400);
  return s;
}

/// Slivers 100 long and 2,000 to 5,000 times as thin, and spheres that lie on them, 1 to 5 % of their radius deep, each
/// above a point inside one. The slivers do not depend on the seed.
inline scene long_slivers_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  constexpr double size = 100;
  scene s;
  s.radius = 2;
  random_numbers of_slivers(12), random(seed + 13);
  for (std::size_t i = 0; i < triangles; ++i) {
    point const middle = of_slivers.in_cube(500), along = size * normalized(of_slivers.in_cube(1));
    point const aside = normalized(cross(along, of_slivers.in_cube(1)));
    point const top = middle + of_slivers.between(-0.4, 0.4) * along + size / of_slivers.between(2000, 5000) * aside;
    add_triangle(s, middle - 0.5 * along, middle + 0.5 * along, top);
  }
  for (std::size_t i = 0; i < spheres && triangles > 0; ++i) {
    std::size_t const corner = 3 * random.below(triangles);
    point const a = vertex_of(s, corner), ab = vertex_of(s, corner + 1) - a, ac = vertex_of(s, corner + 2) - a;
    double const u = random.unit(), v = random.unit() * (1 - u);
    double const height = s.radius * (1 - random.between(0.01, 0.05));
    add_point(s.centres, a + u * ab + v * ac + height * normalized(cross(ab, ac)));
  }
  return s;
}

/// A soup of small triangles, and one a million times as large.
inline scene giant_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 1;
  random_numbers random(seed);
  for (std::size_t i = 0; i + 1 < triangles; ++i) {
    point const at = random.in_cube(100);
    add_triangle(s, random.in_cube(1, at), random.in_cube(1, at), random.in_cube(1, at));
  }
  if (triangles > 0) add_triangle(s, {-1e6, -1e6, -3}, {1e6, -1e6, 5}, {0, 1e6, 2});
  add_spheres(s, spheres, random, 110);
  return s;
}

/// All triangles and all spheres within a radius of one point.
inline scene pile_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 3;
  random_numbers random(seed);
  for (std::size_t i = 0; i < triangles; ++i) {
    add_triangle(s, random.in_cube(1), random.in_cube(1), random.in_cube(1));
  }
  add_spheres(s, spheres, random, 4);
  return s;
}

}  // namespace io
