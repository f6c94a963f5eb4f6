/// \file
/// Surfaces that scenes are made of.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "scene.hpp"

namespace io {

inline constexpr double pi = 3.14159265358979323846;

/// How to lay about `triangles` triangles out as columns x rows x 2, with `ratio` columns to a row.
inline std::pair<std::size_t, std::size_t> grid_of(std::size_t triangles, double ratio) {
  double const cells = static_cast<double>(triangles) / 2;
  auto const columns = static_cast<std::size_t>(std::max(3.0, std::round(std::sqrt(cells * ratio))));
  auto const rows = static_cast<std::size_t>(std::max(3.0, std::round(cells / static_cast<double>(columns))));
  return {columns, rows};
}

/// Adds the surface (i, j) -> point, with `columns` x `rows` quadrangles of two triangles each; closed in a direction
/// if the last quadrangle meets the first.
template <class Surface>
void add_surface(scene& s, std::size_t columns, std::size_t rows, bool closed, Surface const& surface) {
  auto const first = s.vertices.size() / 3;
  auto const across = closed ? columns : columns + 1, along = closed ? rows : rows + 1;
  s.vertices.reserve(s.vertices.size() + 3 * across * along);
  s.corners.reserve(s.corners.size() + 6 * columns * rows);
  for (std::size_t i = 0; i < across; ++i) {
    for (std::size_t j = 0; j < along; ++j) {
      add_point(s.vertices, surface(static_cast<double>(i) / static_cast<double>(columns),
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

/// Adds a parallelogram that two edges span from a corner.
inline void add_plate(scene& s, point const& corner, point const& a, point const& b, std::size_t columns = 4,
                      std::size_t rows = 4) {
  add_surface(s, columns, rows, false, [&](double across, double along) { return corner + across * a + along * b; });
}

/// Adds a cylinder without ends around the line between two points, of so many sides.
inline void add_tube(scene& s, point const& from, point const& to, double radius, std::size_t sides) {
  point const axis = to - from, any = {0, axis[2] == 0 ? 0.0 : 1.0, axis[2] == 0 ? 1.0 : 0.0};
  point const u = normalized(cross(axis, any)), v = normalized(cross(axis, u));
  add_surface(s, sides, 4, false, [&](double across, double along) {
    double const angle = 2 * pi * across;
    return from + along * axis + radius * std::cos(angle) * u + radius * std::sin(angle) * v;
  });
}

/// The torus of the study, of about so many triangles, around `centre`.
inline void add_torus(scene& s, std::size_t triangles, point const& centre) {
  auto const [columns, rows] = grid_of(triangles, 192.0 / 164);
  add_surface(s, columns, rows, true, [&](double across, double along) {
    double const u = 2 * pi * across, v = 2 * pi * along;
    double const r = 120 * (1 + 0.12 * std::sin(5 * u) * std::cos(3 * v));
    double const d = 300 + r * std::cos(v);
    return point{centre[0] + d * std::cos(u), centre[1] + d * std::sin(u), centre[2] + r * std::sin(v)};
  });
}

/// The height of hilly ground above (x, y).
inline double hills(double x, double y) {
  return 40 * std::sin(x / 90) * std::cos(y / 70) + 9 * std::sin(x / 17 + y / 23);
}

/// Adds hilly ground, 1000 x 1000 around the origin, of about so many triangles.
inline void add_hills(scene& s, std::size_t triangles) {
  auto const [columns, rows] = grid_of(triangles, 1);
  add_surface(s, columns, rows, false, [](double across, double along) {
    double const x = 1000 * (across - 0.5), y = 1000 * (along - 0.5);
    return point{x, y, hills(x, y)};
  });
}

/// Adds the tube of a surface of revolution: `rings` rings of `around` vertices, ring(k, u) the point of ring k at the
/// angle u, and two triangles to each of the (rings - 1) x around quadrangles between them. Its vertex i of ring k is
/// the number returned + k * around + i.
template <class Ring>
std::uint32_t add_tube(scene& s, std::size_t around, std::size_t rings, Ring const& ring) {
  auto const first = static_cast<std::uint32_t>(s.vertices.size() / 3);
  for (std::size_t k = 0; k < rings; ++k) {
    for (std::size_t i = 0; i < around; ++i) {
      add_point(s.vertices, ring(k, 2 * pi * static_cast<double>(i) / static_cast<double>(around)));
    }
  }
  auto const number = [&](std::size_t i, std::size_t k) {
    return static_cast<std::uint32_t>(first + k * around + i % around);
  };
  for (std::size_t k = 0; k + 1 < rings; ++k) {
    for (std::size_t i = 0; i < around; ++i) {
      auto const a = number(i, k), b = number(i + 1, k), c = number(i + 1, k + 1), d = number(i, k + 1);
      s.corners.insert(s.corners.end(), {a, b, c, a, c, d});
    }
  }
  return first;
}

/// Adds the fan of a ring's triangles around the vertex `middle`: the ring's first vertex has the number `first`, and
/// `turned` tells the way round.
inline void add_fan(scene& s, std::uint32_t middle, std::uint32_t first, std::size_t around, bool turned) {
  for (std::size_t i = 0; i < around; ++i) {
    auto const a = static_cast<std::uint32_t>(first + i), b = static_cast<std::uint32_t>(first + (i + 1) % around);
    s.corners.insert(s.corners.end(), {middle, turned ? b : a, turned ? a : b});
  }
}

/// Adds a capsule from `a` to `b`, 2 * around * rings triangles with a vertex at either pole.
inline void add_capsule(scene& s, point const& a, point const& b, double r, std::size_t around, std::size_t rings) {
  point const z = normalized(b - a), x = normalized(cross(std::abs(z[2]) < 0.9 ? point{0, 0, 1} : point{1, 0, 0}, z));
  point const y = cross(z, x);
  double const straight = length(b - a), whole = straight + pi * r, quarter = pi / 2 * r;
  auto const south = static_cast<std::uint32_t>(s.vertices.size() / 3);
  add_point(s.vertices, a - r * z);
  add_fan(s, south, south + 1, around, true);
  add_tube(s, around, rings, [&](std::size_t k, double u) {
    // along the outline: a quarter of a circle, a line, a quarter of a circle
    double const t = whole * static_cast<double>(k + 1) / static_cast<double>(rings + 1);
    double height = t - quarter, d = r;
    if (t < quarter) {
      height = -r * std::cos(t / r);
      d = r * std::sin(t / r);
    } else if (t >= quarter + straight) {
      height = straight + r * std::sin((t - quarter - straight) / r);
      d = r * std::cos((t - quarter - straight) / r);
    }
    return a + height * z + (d * std::cos(u)) * x + (d * std::sin(u)) * y;
  });
  auto const north = static_cast<std::uint32_t>(s.vertices.size() / 3);
  add_point(s.vertices, b + r * z);
  add_fan(s, north, static_cast<std::uint32_t>(north - around), around, false);
}

/// Adds the surface of a box: 12 triangles.
inline void add_box(scene& s, point const& middle, point const& half) {
  auto const first = static_cast<std::uint32_t>(s.vertices.size() / 3);
  for (auto const& sign : {point{-1, -1, -1}, point{1, -1, -1}, point{1, 1, -1}, point{-1, 1, -1}, point{-1, -1, 1},
                           point{1, -1, 1}, point{1, 1, 1}, point{-1, 1, 1}}) {
    add_point(s.vertices,
              {middle[0] + sign[0] * half[0], middle[1] + sign[1] * half[1], middle[2] + sign[2] * half[2]});
  }
  for (std::uint32_t const corner :
       {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7}) {
    s.corners.push_back(first + corner);
  }
}

}  // namespace io
