/// \file
/// Meshes that are hard for trees of boxes.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <collide/mesh.hpp>

namespace tests {

/// A triangle soup with a name.
template <class S>
struct hard_mesh {
  std::string name;
  std::vector<S> corners;

  std::size_t size() const { return corners.size() / 9; }
  collide::mesh_view<S> view() const { return collide::triangle_soup(corners.data(), size()); }
  /// How far from the origin its finite corners are along an axis, at most.
  S extent() const {
    S most = 0;
    for (S const x : corners) {
      if (std::isfinite(x)) most = std::max(most, std::abs(x));
    }
    return most;
  }
};

/// Needles, giants, triangles of all sizes, all at one place, of no area, not finite, far from the origin; one, and
/// few.
template <class S>
std::vector<hard_mesh<S>> hard_meshes(std::size_t n) {
  std::mt19937 engine(46);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto const draw = [&] { return uniform(engine); };
  std::vector<hard_mesh<S>> all;
  auto const add = [&](std::string const& name, std::size_t count, auto const& corner_of) {
    hard_mesh<S> mesh{name, {}};
    for (std::size_t i = 0; i < count; ++i) {
      double const at[] = {draw(), draw(), draw()}, along[] = {draw(), draw(), draw()};
      for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < 3; ++k) mesh.corners.push_back(static_cast<S>(corner_of(i, at[k], along[k], c)));
      }
    }
    all.push_back(std::move(mesh));
  };
  auto const small = [&](std::size_t, double at, double, int) { return at + 0.05 * draw(); };
  add("one triangle", 1, small);
  add("eight triangles", 8, small);
  add("nine triangles", 9, small);
  add("a soup", n, small);
  add("needles", n, [&](std::size_t, double at, double along, int c) { return at + c * 0.5 * along + 1e-3 * draw(); });
  add("giants", n, [&](std::size_t i, double at, double, int) { return at + (i % 100 == 7 ? 30 : 0.01) * draw(); });
  add("all sizes", n, [&](std::size_t i, double at, double, int) {
    double const size = std::pow(0.5, static_cast<double>(i % 40));
    return size * (at + 0.3 * draw());
  });
  add("all at one place", 200, [](std::size_t, double, double, int c) { return 0.25 * c * c; });
  add("segments and points", n,
      [&](std::size_t i, double at, double along, int c) { return at + (i % 3 == 0 ? 0 : 0.1 * (c % 2) * along); });
  add("some that are not finite", n, [&](std::size_t i, double at, double, int c) {
    double const bad = i % 2 == 0 ? std::numeric_limits<double>::infinity() : std::nan("");
    return i % 5 == 2 && c == 1 ? bad : at + 0.05 * draw();
  });
  add("none that is finite", 20, [](std::size_t, double, double, int) { return std::nan(""); });
  add("far from the origin", n,
      [&](std::size_t, double at, double, int) { return (sizeof(S) == 4 ? 1e4 : 1e10) + at + 0.05 * draw(); });
  add("of the largest numbers", 300, [&](std::size_t, double at, double, int) {
    return 0.9 * static_cast<double>(std::numeric_limits<S>::max()) * (at * 0.9 + 0.1 * draw());
  });
  add("of subnormal numbers", 300, [&](std::size_t, double at, double, int) {
    return static_cast<double>(std::numeric_limits<S>::min()) * (at + 0.1 * draw());
  });
  return all;
}

}  // namespace tests
