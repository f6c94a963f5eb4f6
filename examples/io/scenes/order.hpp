/// \file
/// The same scene with its triangles, vertices or spheres in another order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "scene.hpp"

namespace io {

/// Orders of triangles, of vertices or of spheres.
enum class order {
  made,      ///< as the scene was made
  shuffled,  ///< at random
  along_x,   ///< by x, of triangles that of the first corner
  halves,    ///< first those of even numbers: of triangles the lower halves of quads, where these are two in a row
};

/// The numbers 0 .. n - 1 in an order; `x(i)` is the place of number i on the x axis.
template <class X>
std::vector<std::size_t> numbers_in(order wanted, std::size_t n, random_numbers& random, X const& x) {
  std::vector<std::size_t> numbers(n);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  if (wanted == order::shuffled) {
    for (std::size_t i = n; i > 1; --i) std::swap(numbers[i - 1], numbers[random.below(i)]);
  } else if (wanted == order::along_x) {
    std::stable_sort(numbers.begin(), numbers.end(), [&](std::size_t a, std::size_t b) { return x(a) < x(b); });
  } else if (wanted == order::halves) {
    std::stable_partition(numbers.begin(), numbers.end(), [](std::size_t i) { return i % 2 == 0; });
  }
  return numbers;
}

/// The items, of `width` values each, in the order of their numbers.
template <class T>
std::vector<T> in_order(std::vector<T> const& from, std::vector<std::size_t> const& numbers, std::size_t width) {
  std::vector<T> to(from.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < width; ++k) to[width * i + k] = from[width * numbers[i] + k];
  }
  return to;
}

inline void order_triangles(scene& s, order wanted, std::uint64_t seed) {
  random_numbers random(seed + 11);
  auto const x = [&](std::size_t i) { return vertex_of(s, 3 * i)[0]; };
  s.corners = in_order(s.corners, numbers_in(wanted, s.triangle_count(), random, x), 3);
}

/// Gives the vertices other numbers; the triangles stay where they are.
inline void order_vertices(scene& s, order wanted, std::uint64_t seed) {
  random_numbers random(seed + 12);
  auto const numbers =
      numbers_in(wanted, s.vertices.size() / 3, random, [&](std::size_t i) { return s.vertices[3 * i]; });
  std::vector<std::uint32_t> number_now(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) number_now[numbers[i]] = static_cast<std::uint32_t>(i);
  s.vertices = in_order(s.vertices, numbers, 3);
  for (auto& c : s.corners) c = number_now[c];
}

inline void order_spheres(scene& s, order wanted, std::uint64_t seed) {
  random_numbers random(seed + 13);
  auto const numbers = numbers_in(wanted, s.sphere_count(), random, [&](std::size_t i) { return s.centres[3 * i]; });
  s.centres = in_order(s.centres, numbers, 3);
  if (!s.radii.empty()) s.radii = in_order(s.radii, numbers, 1);
}

}  // namespace io
