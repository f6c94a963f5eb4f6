/// Boxes of pieces that go one way, and how many pieces there are.
#include <algorithm>
#include <cstddef>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/broad/detail/tree/triangle_pieces.hpp>
#include <collide/host.hpp>

#include "hard_meshes.hpp"

using namespace collide::detail;

namespace {

bool contains(aabb<float> const& outer, aabb<float> const& inner) {
  bool all = true;
  for (int k = 0; k < 3; ++k) all = all && outer.lower[k] <= inner.lower[k] && outer.upper[k] >= inner.upper[k];
  return all;
}

/// True if numbers from piece to piece never fall, or never rise.
template <class F>
bool goes_one_way(std::size_t n, F const& f) {
  bool rises = true, falls = true;
  for (std::size_t k = 1; k < n; ++k) {
    rises = rises && f(k - 1) <= f(k);
    falls = falls && f(k - 1) >= f(k);
  }
  return rises || falls;
}

}  // namespace

TEST_CASE("triangle pieces: boxes only grow, go one way on each axis, and those that overlap a box follow each other") {
  std::mt19937 engine(46);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::size_t wrong = 0, apart_before = 0, apart = 0;
  for (int round = 0; round < 500; ++round) {
    auto const n = static_cast<std::size_t>(2 + round % 20);
    std::vector<triangle_piece> pieces(n);
    float const slope[] = {uniform(engine), uniform(engine), uniform(engine)};
    for (std::size_t i = 0; i < n; ++i) {
      for (int k = 0; k < 3; ++k) {  // along a line, except for some noise
        float const at = slope[k] * static_cast<float>(i) + 0.3f * uniform(engine);
        pieces[i].box.lower[k] = at;
        pieces[i].box.upper[k] = at + 0.5f + 0.5f * uniform(engine);
      }
    }
    std::vector<triangle_piece> const before = pieces;
    make_monotone(pieces.data(), static_cast<std::uint32_t>(n));
    for (std::size_t i = 0; i < n; ++i) wrong += !contains(pieces[i].box, before[i].box);
    for (int k = 0; k < 3; ++k) {
      wrong += !goes_one_way(n, [&](std::size_t i) { return pieces[i].box.lower[k]; });
      wrong += !goes_one_way(n, [&](std::size_t i) { return pieces[i].box.upper[k]; });
    }
    for (int t = 0; t < 20; ++t) {
      tree_point around;
      for (int k = 0; k < 3; ++k) {
        around.lower[k] = static_cast<float>(n) * slope[k] * (0.5f + 0.5f * uniform(engine));
        around.upper[k] = around.lower[k] + 0.2f;
      }
      auto const runs = [&](std::vector<triangle_piece> const& of) {
        int begun = 0;
        for (std::size_t i = 0; i < n; ++i)
          begun += overlap(of[i].box, around) && (i == 0 || !overlap(of[i - 1].box, around));
        return begun;
      };
      apart_before += runs(before) > 1;
      apart += runs(pieces) > 1;
    }
  }
  CHECK(wrong == 0);
  CHECK(apart_before > 10);  // else there was nothing to mend
  CHECK(apart == 0);
}

TEST_CASE("triangle pieces: few where boxes are seldom in each other's way, at most 16 a triangle where they are") {
  collide::host space(2);
  auto const pieces_a_triangle = [&](std::size_t n, double length) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<float> corners;
    for (std::size_t i = 0; i < n; ++i) {
      double at[3], along[3];
      for (double& x : at) x = uniform(engine);
      for (double& x : along) x = length * (uniform(engine) < 0 ? -1 : 1);
      for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < 3; ++k)
          corners.push_back(static_cast<float>(at[k] + (c == 1 ? 1 : 0) * along[k] + 1e-4 * uniform(engine)));
      }
    }
    triangle_pieces<float> of;
    return static_cast<double>(of.build(space, collide::triangle_soup(corners.data(), n))) / static_cast<double>(n);
  };
  CHECK(pieces_a_triangle(1000, 0.05) > 1);
  CHECK(pieces_a_triangle(1000, 0.05) <= 2);
  CHECK(pieces_a_triangle(3000, 30) > 6);
  CHECK(pieces_a_triangle(3000, 30) <= 16);
  CHECK(pieces_a_triangle(3000, 30) > pieces_a_triangle(300, 30) + 3);
  auto const soup = tests::hard_meshes<double>(100)[3];
  CHECK(triangle_pieces<double>().build(space, soup.view()) == 0);
}
