/// \file
/// Scenes of long thin triangles, and of few giants among many small ones, all turned against the axes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene.hpp"

namespace io {

namespace detail {

/// A bar from one point to another.
struct bar {
  point from, to;
};

/// A point turned around (1, 1, 1) and then around x, so that no axis stays one.
inline point turned(point const& p) {
  constexpr double c = 0.8, s = 0.6;
  double const mean = (p[0] + p[1] + p[2]) / 3, k = 0.35;
  point const axis{mean, mean, mean}, along{p[1] - p[2], p[2] - p[0], p[0] - p[1]};
  point const q = axis + std::cos(k) * (p - axis) + (-std::sin(k) / std::sqrt(3.0)) * along;
  return {q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]};
}

/// Adds the three sides of a prism around a bar, two triangles each, `width` wide.
inline void add_bar(scene& s, bar const& b, double width) {
  point const along = normalized(b.to - b.from);
  point const other = std::abs(along[0]) < 0.9 ? point{1, 0, 0} : point{0, 1, 0};
  point const u = normalized(cross(along, other)), v = cross(along, u);
  point around[3];
  for (int k = 0; k < 3; ++k) {
    double const angle = 2.0943951023931953 * k, r = width / std::sqrt(3.0);
    around[k] = (r * std::cos(angle)) * u + (r * std::sin(angle)) * v;
  }
  for (int k = 0; k < 3; ++k) {
    point const a = b.from + around[k], c = b.from + around[(k + 1) % 3], l = b.to - b.from;
    add_triangle(s, turned(a), turned(c), turned(a + l));
    add_triangle(s, turned(c), turned(c + l), turned(a + l));
  }
}

/// Adds spheres of which each is near a bar: its centre within two radii of the axis.
inline void add_spheres_at(scene& s, std::size_t n, std::vector<bar> const& bars, random_numbers& random) {
  for (std::size_t i = 0; i < n && !bars.empty(); ++i) {
    bar const& b = bars[random.below(bars.size())];
    add_point(s.centres, turned(random.in_cube(2 * s.radius, b.from + random.unit() * (b.to - b.from))));
  }
}

}  // namespace detail

/// How bars lie: around a tube whose wall they are; in a bundle, as a shaft; along the edges of a lattice, as a cage;
/// along its diagonals too, as a truss; anywhere.
enum class bars_in { tube, shaft, cage, truss, air };

/// Bars 1,000 units long in all, or as the layout divides them, each `slender` times as long as wide, six triangles
/// each. The radius is `reach` times how far bars that lie next to each other are apart.
inline scene bars_scene(bars_in layout, double slender, double reach, std::size_t spheres, std::size_t triangles,
                        std::uint64_t seed) {
  scene s;
  random_numbers random(seed + 46);
  std::size_t const n = std::max<std::size_t>(triangles / 6, 1);
  auto const count = static_cast<double>(n);
  std::vector<detail::bar> bars;
  double apart = 1, size = 1000;
  if (layout == bars_in::tube) {
    // rows of bars that follow each other along the tube; in a row they touch
    double const around = 2 * 3.141592653589793 * 300,
                 rows = std::max(1.0, std::round(std::sqrt(count * size / around / slender)));
    auto const in_row = static_cast<std::size_t>(std::max(3.0, count / rows));
    size /= rows;
    apart = around / static_cast<double>(in_row);
    for (std::size_t i = 0; i < n; ++i) {
      double const angle = around / 300 * static_cast<double>(i % in_row) / static_cast<double>(in_row);
      point const at{300 * std::cos(angle), 300 * std::sin(angle), size * static_cast<double>(i / in_row) - 500};
      bars.push_back({at, at + point{0, 0, size}});
    }
  } else if (layout == bars_in::shaft) {
    apart = std::sqrt(3.141592653589793 * 200 * 200 / count);
    for (std::size_t i = 0; i < n; ++i) {  // at equal distances on a spiral
      double const r = 200 * std::sqrt((static_cast<double>(i) + 0.5) / count),
                   angle = 2.399963229728653 * static_cast<double>(i);
      point const at{r * std::cos(angle), r * std::sin(angle), -500};
      bars.push_back({at, at + point{0, 0, size}});
    }
  } else if (layout == bars_in::air) {
    apart = size / std::cbrt(count);
    for (std::size_t i = 0; i < n; ++i) {
      point const at = random.in_cube(500), half = (size / 8) * normalized(random.in_cube(1));
      bars.push_back({at - half, at + half});
    }
    size /= 4;
  } else {
    bool const braced = layout == bars_in::truss;
    std::size_t const cells = std::max<std::size_t>(n / (braced ? 6 : 3), 1);
    auto const side = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(cells)) - 1e-9));
    apart = size /= static_cast<double>(side);
    for (std::size_t i = 0; i < cells; ++i) {
      auto const c = [&](std::size_t k) { return size * static_cast<double>(k) - 500; };
      point const at{c(i % side), c(i / side % side), c(i / side / side)};
      for (std::size_t k = 0; k < 3; ++k) {
        point edge{}, diagonal{size, size, size};
        edge[k] = size;
        diagonal[k] = 0;
        bars.push_back({at, at + edge});
        if (braced) bars.push_back({at, at + diagonal});
      }
    }
  }
  s.radius = reach * apart;
  for (auto const& b : bars) detail::add_bar(s, b, length(b.to - b.from) / slender);
  detail::add_spheres_at(s, spheres, bars, random);
  return s;
}

/// Small triangles in a cube, and giants that go through all of it.
inline scene giants_scene(std::size_t giants, std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 1;
  random_numbers random(seed + 47);
  for (std::size_t i = giants; i < triangles; ++i) {
    point const at = random.in_cube(500);
    add_triangle(s, random.in_cube(2, at), random.in_cube(2, at), random.in_cube(2, at));
  }
  for (std::size_t i = 0; i < giants; ++i) {
    point const at = random.in_cube(300), u = 3000.0 * normalized(random.in_cube(1)),
                v = 3000.0 * normalized(random.in_cube(1));
    add_triangle(s, at - u, at + u, at + v);
  }
  add_spheres(s, spheres, random, 500);
  return s;
}

}  // namespace io
