/// \file
/// Scenes around the torus of the study.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "surfaces.hpp"

namespace io {

/// The study's size.
inline constexpr std::size_t study_triangles = 192 * 164 * 2;
inline constexpr std::size_t study_spheres = 1'703'244;

/// Half the width of the cube that the study's spheres are uniform in.
inline constexpr double study_cube = 592.2;

/// The scene of the study: a closed bumpy torus (of 192 x 164 x 2 triangles, or about as many as asked for) among
/// spheres of radius 3, uniform in a cube.
inline scene study_scene(std::size_t spheres = study_spheres, std::size_t triangles = study_triangles,
                         std::uint64_t seed = 0) {
  scene s;
  s.radius = 3;
  add_torus(s, triangles, {});
  random_numbers random(seed);
  add_spheres(s, spheres, random, study_cube);
  return s;
}

/// The study's scene with radii that shrink as triangles become more, so that a sphere touches about as many.
inline scene finer_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s = study_scene(spheres, triangles, seed);
  s.radius = 3 * std::sqrt(static_cast<double>(study_triangles) / static_cast<double>(triangles));
  return s;
}

/// The study's torus, and spheres of one radius on it: each within 5 of a vertex, on every axis.
inline scene hits_scene(double radius, std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s = study_scene(0, triangles);
  s.radius = radius;
  random_numbers random(seed + 1);
  for (std::size_t i = 0; i < spheres; ++i) {
    add_point(s.centres, random.in_cube(5, vertex_of(s, random.below(s.corners.size()))));
  }
  return s;
}

/// The study's scene with radii from 0.03 to 30, as many of each order of magnitude.
inline scene radii_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s = study_scene(spheres, triangles, seed);
  random_numbers random(seed + 1);
  s.radii.resize(spheres);
  for (auto& r : s.radii) r = 0.03 * std::pow(1000.0, random.unit());
  return s;
}

/// The study's scene with radii from 30 / ratio to 30, as many of each order of magnitude.
inline scene ratio_scene(double ratio, std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s = study_scene(spheres, triangles, seed);
  random_numbers random(seed + 2);
  s.radii.resize(spheres);
  for (auto& r : s.radii) r = 30 * std::pow(ratio, -random.unit());
  return s;
}

/// The study's torus, and spheres of radius 3 in a cube of this half-width around one of its vertices.
inline scene crowd_scene(double half, std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s = study_scene(0, triangles);
  random_numbers random(seed + 3);
  add_spheres(s, spheres, random, half, {s.vertices[0], s.vertices[1], s.vertices[2]});
  return s;
}

/// Two tori a million radii apart, each among half of the spheres.
inline scene clusters_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  point const there{3e6, 0, 0};
  scene s;
  s.radius = 3;
  add_torus(s, triangles / 2, {});
  add_torus(s, triangles - triangles / 2, there);
  random_numbers random(seed);
  add_spheres(s, spheres / 2, random, study_cube);
  add_spheres(s, spheres - spheres / 2, random, study_cube, there);
  return s;
}

}  // namespace io
