/// \file
/// Scenes to detect collisions in, the same on every machine.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace io {

/// A mesh and spheres. `radii` holds one radius per sphere, or is empty: then all have `radius`.
struct scene {
  std::vector<double> vertices;        ///< x0, y0, z0, x1, ...
  std::vector<std::uint32_t> corners;  ///< three vertex numbers per triangle
  std::vector<double> centres;         ///< x0, y0, z0, x1, ...
  std::vector<double> radii;
  double radius = 0;

  std::size_t triangle_count() const { return corners.size() / 3; }
  std::size_t sphere_count() const { return centres.size() / 3; }
};

using point = std::array<double, 3>;

/// Random numbers that are the same with every standard library: those of <random> prescribe the generator bit by bit,
/// but not what its distributions make of it.
class random_numbers {
 public:
  explicit random_numbers(std::uint64_t seed) : bits_{seed} {}

  /// Uniform in [0, 1).
  double unit() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  /// Uniform in [from, to).
  double between(double from, double to) { return from + (to - from) * unit(); }
  /// Uniform in a cube of this half-width around `centre`.
  point in_cube(double half, point const& centre = {}) {
    double const x = between(-half, half), y = between(-half, half), z = between(-half, half);
    return {centre[0] + x, centre[1] + y, centre[2] + z};
  }

 private:
  std::mt19937_64 bits_;
};

namespace detail {

constexpr double pi = 3.14159265358979323846;

inline void add_point(std::vector<double>& to, point const& p) { to.insert(to.end(), p.begin(), p.end()); }

inline void add_triangle(scene& s, point const& a, point const& b, point const& c) {
  auto const first = static_cast<std::uint32_t>(s.vertices.size() / 3);
  for (auto const& p : {a, b, c}) add_point(s.vertices, p);
  s.corners.insert(s.corners.end(), {first, first + 1, first + 2});
}

/// How to lay about `triangles` triangles out as columns x rows x 2, with `ratio` columns to a row.
inline std::pair<std::size_t, std::size_t> grid(std::size_t triangles, double ratio) {
  double const cells = static_cast<double>(triangles) / 2;
  auto const columns = static_cast<std::size_t>(std::max(3.0, std::round(std::sqrt(cells * ratio))));
  auto const rows = static_cast<std::size_t>(std::max(3.0, std::round(cells / static_cast<double>(columns))));
  return {columns, rows};
}

}  // namespace detail

/// Adds the surface (i, j) -> point, with `columns` x `rows` quadrangles of two triangles each; closed in a direction
/// if the last quadrangle meets the first.
template <class Surface>
void add_surface(scene& s, std::size_t columns, std::size_t rows, bool closed, Surface const& surface) {
  auto const first = s.vertices.size() / 3;
  auto const across = closed ? columns : columns + 1, along = closed ? rows : rows + 1;
  for (std::size_t i = 0; i < across; ++i) {
    for (std::size_t j = 0; j < along; ++j) {
      detail::add_point(s.vertices, surface(static_cast<double>(i) / static_cast<double>(columns),
                                            static_cast<double>(j) / static_cast<double>(rows)));
    }
  }
  auto const number = [&](std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>(first + i % across * along + j % along);
  };
  for (std::size_t i = 0; i < columns; ++i) {
    for (std::size_t j = 0; j < rows; ++j) {
      auto const a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1), d = number(i, j + 1);
      s.corners.insert(s.corners.end(), {a, b, c, a, c, d});
    }
  }
}

namespace detail {

inline void add_torus(scene& s, std::size_t triangles, point const& centre) {
  auto const [columns, rows] = grid(triangles, 192.0 / 164);
  add_surface(s, columns, rows, true, [&](double across, double along) {
    double const u = 2 * pi * across, v = 2 * pi * along;
    double const r = 120 * (1 + 0.12 * std::sin(5 * u) * std::cos(3 * v));
    double const d = 300 + r * std::cos(v);
    return point{centre[0] + d * std::cos(u), centre[1] + d * std::sin(u), centre[2] + r * std::sin(v)};
  });
}

inline void add_spheres(scene& s, std::size_t n, random_numbers& random, double half, point const& centre = {}) {
  s.centres.reserve(s.centres.size() + 3 * n);
  for (std::size_t i = 0; i < n; ++i) add_point(s.centres, random.in_cube(half, centre));
}

}  // namespace detail

/// The study's size.
inline constexpr std::size_t study_triangles = 192 * 164 * 2;
inline constexpr std::size_t study_spheres = 1'703'244;

/// The scene of the study: a closed bumpy torus (of 192 x 164 x 2 triangles, or about as many as asked for) among
/// spheres of radius 3, uniform in a cube.
inline scene study_scene(std::size_t spheres = study_spheres, std::size_t triangles = study_triangles,
                         std::uint64_t seed = 0) {
  scene s;
  s.radius = 3;
  detail::add_torus(s, triangles, {});
  random_numbers random(seed);
  detail::add_spheres(s, spheres, random, 592.2);
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

/// A ball, and spheres around its surface: the triangles at its poles are degenerate.
inline scene ball_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 3;
  auto const [columns, rows] = detail::grid(triangles, 2);
  add_surface(s, columns, rows, false, [](double across, double along) {
    double const u = 2 * detail::pi * across, v = detail::pi * along;
    return point{300 * std::sin(v) * std::cos(u), 300 * std::sin(v) * std::sin(u), 300 * std::cos(v)};
  });
  random_numbers random(seed);
  detail::add_spheres(s, spheres, random, 350);
  return s;
}

/// Hilly ground, and spheres in the air just above and below it.
inline scene terrain_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  auto const height = [](double x, double y) {
    return 40 * std::sin(x / 90) * std::cos(y / 70) + 9 * std::sin(x / 17 + y / 23);
  };
  scene s;
  s.radius = 1;
  auto const [columns, rows] = detail::grid(triangles, 1);
  add_surface(s, columns, rows, false, [&](double across, double along) {
    double const x = 1000 * (across - 0.5), y = 1000 * (along - 0.5);
    return point{x, y, height(x, y)};
  });
  random_numbers random(seed);
  for (std::size_t i = 0; i < spheres; ++i) {
    double const x = random.between(-500, 500), y = random.between(-500, 500);
    detail::add_point(s.centres, {x, y, height(x, y) + random.between(-5, 45)});
  }
  return s;
}

/// Triangles half a thousand long and a thousandth wide, every way round.
inline scene slivers_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 3;
  random_numbers random(seed);
  for (std::size_t i = 0; i < triangles; ++i) {
    point const a = random.in_cube(300), along = random.in_cube(250), aside = random.in_cube(0.001);
    point b{}, c{};
    for (std::size_t k = 0; k < 3; ++k) {
      b[k] = a[k] + along[k];
      c[k] = b[k] + aside[k];
    }
    detail::add_triangle(s, a, b, c);
  }
  detail::add_spheres(s, spheres, random, 400);
  return s;
}

/// A soup of small triangles, and one a million times as large.
inline scene giant_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 1;
  random_numbers random(seed);
  for (std::size_t i = 0; i + 1 < triangles; ++i) {
    point const at = random.in_cube(100);
    detail::add_triangle(s, random.in_cube(1, at), random.in_cube(1, at), random.in_cube(1, at));
  }
  if (triangles > 0) detail::add_triangle(s, {-1e6, -1e6, -3}, {1e6, -1e6, 5}, {0, 1e6, 2});
  detail::add_spheres(s, spheres, random, 110);
  return s;
}

/// Two tori a million radii apart, each among half of the spheres.
inline scene clusters_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  point const there{3e6, 0, 0};
  scene s;
  s.radius = 3;
  detail::add_torus(s, triangles / 2, {});
  detail::add_torus(s, triangles - triangles / 2, there);
  random_numbers random(seed);
  detail::add_spheres(s, spheres / 2, random, 592.2);
  detail::add_spheres(s, spheres - spheres / 2, random, 592.2, there);
  return s;
}

/// All triangles and all spheres within a radius of one point.
inline scene pile_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 3;
  random_numbers random(seed);
  for (std::size_t i = 0; i < triangles; ++i) {
    detail::add_triangle(s, random.in_cube(1), random.in_cube(1), random.in_cube(1));
  }
  detail::add_spheres(s, spheres, random, 4);
  return s;
}

/// The unit cube of 12 triangles, and four spheres of radius 0.4 of which two touch it.
inline scene cube_scene() {
  scene s;
  s.vertices = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
  s.corners = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
               1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
  s.centres = {0, 0, 0, 3, 3, 3, 0.5, 0.5, 0.5, 1.3, 0, 0.5};
  s.radius = 0.4;
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

/// A scene by its name: `make(spheres, triangles, seed)` gives exactly so many spheres and about so many triangles.
struct scene_kind {
  char const* name;
  char const* about;
  scene (*make)(std::size_t spheres, std::size_t triangles, std::uint64_t seed);
};

inline constexpr scene_kind scene_kinds[] = {
    {"study", "a bumpy torus among spheres of radius 3", study_scene},
    {"radii", "the same with radii from 0.03 to 30, in a column r", radii_scene},
    {"ball", "a ball with degenerate triangles at its poles", ball_scene},
    {"terrain", "hilly ground", terrain_scene},
    {"slivers", "long and thin triangles", slivers_scene},
    {"giant", "a soup of small triangles and one a million times as large", giant_scene},
    {"clusters", "two tori a million radii apart", clusters_scene},
    {"pile", "everything within a radius of one point", pile_scene},
    {"cube", "the unit cube and four spheres", [](std::size_t, std::size_t, std::uint64_t) { return cube_scene(); }},
    {"octahedron", "an octahedron and two spheres",
     [](std::size_t, std::size_t, std::uint64_t) { return octahedron_scene(); }},
};

/// Moves everything.
inline void shift(scene& s, point const& by) {
  for (auto* coordinates : {&s.vertices, &s.centres}) {
    for (std::size_t i = 0; i < coordinates->size(); ++i) (*coordinates)[i] += by[i % 3];
  }
}

}  // namespace io
