/// \file
/// A mesh and spheres, and what scenes are made from: points and random numbers that are the same on every machine.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
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

inline point operator+(point const& a, point const& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline point operator-(point const& a, point const& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline point operator*(double t, point const& a) { return {t * a[0], t * a[1], t * a[2]}; }
inline double dot(point const& a, point const& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline point cross(point const& a, point const& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(point const& a) { return std::sqrt(dot(a, a)); }
inline point normalized(point const& a) { return (1 / length(a)) * a; }

/// Random numbers that are the same with every standard library: those of <random> prescribe the generator bit by bit,
/// but not what its distributions make of it.
class random_numbers {
 public:
  explicit random_numbers(std::uint64_t seed) : bits_{seed} {}

  /// Uniform in [0, 1).
  double unit() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  /// Uniform in [from, to).
  double between(double from, double to) { return from + (to - from) * unit(); }
  /// Uniform among 0 .. n - 1.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(between(0, static_cast<double>(n))); }
  /// Uniform in a cube of this half-width around `centre`.
  point in_cube(double half, point const& centre = {}) {
    double const x = between(-half, half), y = between(-half, half), z = between(-half, half);
    return {centre[0] + x, centre[1] + y, centre[2] + z};
  }

 private:
  std::mt19937_64 bits_;
};

inline void add_point(std::vector<double>& to, point const& p) { to.insert(to.end(), p.begin(), p.end()); }

/// Adds a triangle with vertices of its own.
inline void add_triangle(scene& s, point const& a, point const& b, point const& c) {
  auto const first = static_cast<std::uint32_t>(s.vertices.size() / 3);
  for (auto const& p : {a, b, c}) add_point(s.vertices, p);
  s.corners.insert(s.corners.end(), {first, first + 1, first + 2});
}

/// Adds `n` spheres, uniform in a cube of this half-width around `centre`.
inline void add_spheres(scene& s, std::size_t n, random_numbers& random, double half, point const& centre = {}) {
  s.centres.reserve(s.centres.size() + 3 * n);
  for (std::size_t i = 0; i < n; ++i) add_point(s.centres, random.in_cube(half, centre));
}

/// The place of the vertex that is corner `i` of all corners, three to a triangle.
inline point vertex_of(scene const& s, std::size_t i) {
  std::size_t const first = 3 * std::size_t{s.corners[i]};
  return {s.vertices[first], s.vertices[first + 1], s.vertices[first + 2]};
}

/// Moves everything.
inline void shift(scene& s, point const& by) {
  for (auto* coordinates : {&s.vertices, &s.centres}) {
    for (std::size_t i = 0; i < coordinates->size(); ++i) (*coordinates)[i] += by[i % 3];
  }
}

}  // namespace io
