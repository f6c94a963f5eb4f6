/// \file
/// Triangles of sizes that a test chooses, at random places.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

namespace tests {

/// The corners of `n` triangles, nine numbers each: triangle i is of about the size that size_of(i, draw) gives, at a
/// place no farther than `room` from the origin along each axis; draw() is a random number from -1 to 1.
template <class S, class Size>
std::vector<S> random_triangles(std::size_t n, double const (&room)[3], Size const& size_of) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto const draw = [&] { return uniform(engine); };
  std::vector<S> all;
  for (std::size_t i = 0; i < n; ++i) {
    double const size = size_of(i, draw);
    double at[3];
    for (int k = 0; k < 3; ++k) at[k] = room[k] * draw();
    for (int k = 0; k < 9; ++k) all.push_back(static_cast<S>(at[k % 3] + size * draw()));
  }
  return all;
}

}  // namespace tests
