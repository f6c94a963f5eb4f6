/// Scenes for the tests: plain arrays, made from a seed or read from tests/data.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "../oracle/scene.hpp"

namespace tests {

template <class S>
struct mesh {
  std::vector<S> vertices;             ///< x, y, z, x, y, z, ...
  std::vector<std::uint32_t> corners;  ///< three per triangle

  std::size_t size() const { return corners.size() / 3; }
  oracle::point vertex(std::size_t i) const { return {vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]}; }
  oracle::triangle operator[](std::size_t i) const {
    return {vertex(corners[3 * i]), vertex(corners[3 * i + 1]), vertex(corners[3 * i + 2])};
  }
  /// Appends a triangle with vertices of its own.
  void add(oracle::triangle const& t) {
    for (auto const& p : {t.a, t.b, t.c}) {
      corners.push_back(static_cast<std::uint32_t>(vertices.size() / 3));
      for (double x : {p.x, p.y, p.z}) vertices.push_back(static_cast<S>(x));
    }
  }
};

template <class S>
struct spheres {
  std::vector<S> centres;  ///< x, y, z, x, y, z, ...
  std::vector<S> radii;    ///< one each

  std::size_t size() const { return radii.size(); }
  oracle::sphere operator[](std::size_t i) const {
    return {{centres[3 * i], centres[3 * i + 1], centres[3 * i + 2]}, radii[i]};
  }
  void add(oracle::point const& p, double radius) {
    for (double x : {p.x, p.y, p.z}) centres.push_back(static_cast<S>(x));
    radii.push_back(static_cast<S>(radius));
  }
};

template <class S>
struct scene {
  tests::mesh<S> mesh;
  tests::spheres<S> spheres;

  oracle::expectation expect(double band) const {
    std::vector<oracle::triangle> triangles;
    std::vector<oracle::sphere> balls;
    for (std::size_t i = 0; i < mesh.size(); ++i) triangles.push_back(mesh[i]);
    for (std::size_t i = 0; i < spheres.size(); ++i) balls.push_back(spheres[i]);
    return oracle::expect(triangles, balls, band);
  }
};

/// Numbers that are the same on every platform (the distributions of the standard library are not).
class dice {
 public:
  explicit dice(unsigned seed) : random_{seed} {}
  double uniform(double low, double high) { return low + (high - low) * (static_cast<double>(random_()) * 0x1p-32); }
  int integer(int low, int high) { return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1)); }
  oracle::point in_cube(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }

 private:
  std::mt19937 random_;
};

inline oracle::point operator+(oracle::point const& p, oracle::point const& q) {
  return {p.x + q.x, p.y + q.y, p.z + q.z};
}

/// Options of a random scene.
struct random_scene {
  unsigned seed = 1;
  int triangles = 200, spheres = 200;
  double extent = 6;                 ///< half-width of the cube that everything lies in
  double triangle_size = 1;          ///< half-width of the cube around each triangle
  double radius = 0.5;               ///< of all spheres
  double spread = 1;                 ///< radii lie between radius / spread and radius, uniform in their logarithm
  oracle::point offset = {0, 0, 0};  ///< of everything

  template <class S>
  scene<S> make() const {
    dice roll(seed);
    scene<S> made;
    for (int i = 0; i < triangles; ++i) {
      auto const middle = offset + roll.in_cube(extent);
      auto const corner = [&] { return middle + roll.in_cube(triangle_size); };
      auto const a = corner(), b = corner(), c = corner();
      made.mesh.add({a, b, c});
    }
    for (int i = 0; i < spheres; ++i) {
      auto const centre = offset + roll.in_cube(extent);
      made.spheres.add(centre, spread == 1 ? radius : radius * std::pow(spread, -roll.uniform(0, 1)));
    }
    return made;
  }
};

/// Half squares with legs of 1, 2 or 4 in axis-aligned planes, spheres on half-integer places with radii of 0, 0.5 ..
/// 2, all within `half` of the origin: touching, boundaries and ties everywhere, and every product and quotient exact
/// in float.
template <class S>
scene<S> lattice_scene(unsigned seed, int triangles, int spheres, int half);

/// The closed surface of the cube [0, 1]^3: 12 triangles, faces in the order -z, +z, -y, +y, -x, +x.
template <class S>
mesh<S> unit_cube();

/// Reads a triangle mesh from tests/data.
template <class S>
mesh<S> read_off(std::string const& name);

/// Spheres around the surface of a mesh: each centre is within `reach` (in every coordinate) of a random vertex.
template <class S>
spheres<S> spheres_near(mesh<S> const& m, unsigned seed, int n, double reach, double radius);

}  // namespace tests
