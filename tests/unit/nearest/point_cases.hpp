/// Triangles and points for which it is hard to tell which triangle is nearest, and on which side a point is.
#pragma once

#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <collide/core/geometry.hpp>

#include "../oracle/exact.hpp"
#include "scenes.hpp"

namespace tests {

template <class S>
oracle::point to_oracle(collide::vec3<S> const& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}
template <class S>
oracle::triangle to_oracle(collide::triangle<S> const& t) {
  return {to_oracle(t.a), to_oracle(t.b), to_oracle(t.c)};
}
template <class S>
collide::vec3<S> from_oracle(oracle::point const& p) {
  return {static_cast<S>(p.x), static_cast<S>(p.y), static_cast<S>(p.z)};
}

/// A sphere around a centre, of an icosahedron whose triangles are divided into four `levels` times: closed, and
/// oriented outwards. Corners are rounded to `S`, equal ones to equal numbers.
template <class S>
mesh<S> icosphere(int levels, double radius, oracle::point const& centre) {
  double const g = (1 + std::sqrt(5.0)) / 2;
  std::vector<oracle::point> places{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::uint32_t> corners{0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                                     4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                                     6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    std::vector<std::uint32_t> finer;
    auto const middle = [&](std::uint32_t i, std::uint32_t k) {
      auto const found = middles.emplace(std::minmax(i, k), static_cast<std::uint32_t>(places.size()));
      if (found.second) places.push_back(places[i] + places[k]);
      return found.first->second;
    };
    for (std::size_t t = 0; t < corners.size(); t += 3) {
      std::uint32_t const a = corners[t], b = corners[t + 1], c = corners[t + 2], ab = middle(a, b), bc = middle(b, c),
                          ca = middle(c, a);
      for (std::uint32_t const i : {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca}) finer.push_back(i);
    }
    corners = finer;
    for (auto& p : places) {
      double const length = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
      p = {p.x / length, p.y / length, p.z / length};
    }
  }
  mesh<S> made;
  for (auto const& p : places) {
    double const scale = radius / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    for (double x : {centre.x + scale * p.x, centre.y + scale * p.y, centre.z + scale * p.z})
      made.vertices.push_back(static_cast<S>(x));
  }
  made.corners = corners;
  return made;
}

/// The triangles of a mesh, with values of `S`.
template <class S>
std::vector<collide::triangle<S>> triangles_of(mesh<S> const& m) {
  std::vector<collide::triangle<S>> all;
  for (std::size_t i = 0; i < m.size(); ++i) {
    auto const t = m[i];
    all.push_back({from_oracle<S>(t.a), from_oracle<S>(t.b), from_oracle<S>(t.c)});
  }
  return all;
}

/// A point of a face, an edge or a corner of a random triangle, rounded to `S`, and then moved by up to `ulps` units in
/// the last place.
template <class S>
collide::vec3<S> point_at_surface(std::vector<collide::triangle<S>> const& mesh, dice& roll, int ulps) {
  auto const& t = mesh[static_cast<std::size_t>(roll.integer(0, static_cast<int>(mesh.size()) - 1))];
  double w[3] = {roll.uniform(0, 1), roll.uniform(0, 1), roll.uniform(0, 1)};
  int const zeros = roll.integer(0, 2);
  for (int k = 0; k < zeros; ++k) w[k] = 0;
  double const sum = w[0] + w[1] + w[2];
  collide::vec3<S> p;
  for (int k = 0; k < 3; ++k) {
    auto const x =
        (w[0] * static_cast<double>(t.a[k]) + w[1] * static_cast<double>(t.b[k]) + w[2] * static_cast<double>(t.c[k])) /
        sum;
    p[k] = static_cast<S>(zeros == 2 ? static_cast<double>(t.c[k]) : x);
    for (int steps = roll.integer(-ulps, ulps); steps != 0; steps -= steps < 0 ? -1 : 1)
      p[k] = std::nextafter(p[k], std::copysign(std::numeric_limits<S>::max(), static_cast<S>(steps)));
  }
  return p;
}

}  // namespace tests
