/// \file
/// The points of a depth camera that looks at the arm of a robot.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "surfaces.hpp"

namespace io {

namespace detail {

/// Ten links, in metres: four boxes of 12 triangles, and six capsules of 256 to 13,696 if 30,000 are asked for.
inline void add_arm(scene& s, std::size_t triangles) {
  double const scale = std::sqrt(static_cast<double>(triangles) / 30000);
  auto const capsule = [&](point const& a, point const& b, double r, int around, int rings) {
    auto const part = [&](int n, double least) {
      return static_cast<std::size_t>(std::max(least, std::round(n * scale)));
    };
    add_capsule(s, a, b, r, part(around, 3), part(rings, 2));
  };
  add_box(s, {0, 0, 0.10}, {0.25, 0.25, 0.10});
  capsule({0, 0, 0.25}, {0, 0, 0.55}, 0.09, 16, 8);
  add_box(s, {0, 0, 0.68}, {0.10, 0.12, 0.08});
  capsule({0, 0.05, 0.72}, {0.35, 0.10, 1.05}, 0.07, 24, 24);
  capsule({0.38, 0.10, 1.07}, {0.75, 0.05, 1.02}, 0.06, 32, 32);
  add_box(s, {0.80, 0.05, 1.00}, {0.06, 0.07, 0.07});
  capsule({0.84, 0.05, 0.95}, {0.98, 0.00, 0.70}, 0.045, 48, 48);
  add_box(s, {1.00, 0.00, 0.62}, {0.05, 0.03, 0.02});
  capsule({0.97, 0.025, 0.58}, {0.97, 0.03, 0.48}, 0.012, 64, 64);
  capsule({1.03, -0.025, 0.58}, {1.03, -0.03, 0.48}, 0.012, 64, 107);
}

/// Points that are uniform on the mesh except for noise: 2 mm inside to 2 cm outside.
inline void add_seen(std::vector<point>& points, std::size_t n, scene const& s, random_numbers& random) {
  auto const sides = [&](std::size_t t) {
    point const a = vertex_of(s, 3 * t);
    return std::pair{vertex_of(s, 3 * t + 1) - a, vertex_of(s, 3 * t + 2) - a};
  };
  std::vector<double> area{0};  // of the first triangles
  for (std::size_t t = 0; t < s.triangle_count(); ++t) {
    auto const [ab, ac] = sides(t);
    area.push_back(area.back() + length(cross(ab, ac)) / 2);
  }
  for (std::size_t i = 0; i < n; ++i) {
    double const x = random.between(0, area.back());
    auto const t = static_cast<std::size_t>(std::upper_bound(area.begin(), area.end(), x) - area.begin()) - 1;
    double u = random.unit(), v = random.unit();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    auto const [ab, ac] = sides(t);
    points.push_back(vertex_of(s, 3 * t) + u * ab + v * ac + random.between(-0.002, 0.02) * normalized(cross(ab, ac)));
  }
}

/// Points on a bumpy table of 3 m x 3 m, until there are `n`.
inline void add_table(std::vector<point>& points, std::size_t n, random_numbers& random) {
  while (points.size() < n) {
    double const x = random.between(-1.2, 1.8), y = random.between(-1.5, 1.5);
    double const z = 0.06 * std::sin(7 * x) * std::cos(6 * y) + 0.015 * std::sin(31 * x + 23 * y) - 0.12;
    points.push_back({x, y, z + random.between(-0.002, 0.002)});
  }
}

/// The number of the pixel in which a camera at `eye` sees `p`, line by line.
inline std::uint32_t pixel_of(point const& p, point const& eye) {
  point const d = p - eye;
  auto const line = static_cast<std::uint32_t>(std::atan2(d[2], std::hypot(d[0], d[1])) / pi * 2048 + 4096);
  auto const column = static_cast<std::uint32_t>((std::atan2(d[1], d[0]) / pi + 1) * 4096);
  return line << 16 | column;
}

}  // namespace detail

/// The arm of a robot above a table, and the points that a depth camera sees of both, in the order of its pixels:
/// spheres of 1 cm, a third of them within 2 cm of the arm.
inline scene camera_scene(std::size_t spheres, std::size_t triangles, std::uint64_t seed) {
  scene s;
  s.radius = 0.01;
  detail::add_arm(s, triangles);
  random_numbers random(seed + 8);
  std::vector<point> points;
  points.reserve(spheres);
  detail::add_seen(points, spheres / 3, s, random);
  detail::add_table(points, spheres, random);
  std::vector<std::pair<std::uint32_t, std::size_t>> order;
  for (std::size_t i = 0; i < points.size(); ++i) order.emplace_back(detail::pixel_of(points[i], {2.6, -1.6, 1.9}), i);
  std::sort(order.begin(), order.end());
  for (auto const& [pixel, i] : order) add_point(s.centres, points[i]);
  return s;
}

}  // namespace io
