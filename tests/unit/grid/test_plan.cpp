/// Limits that every plan of grids keeps to, in any scene.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>
#include <io/scenes.hpp>

#include <collide/bucket.cuh>

#include "execution/lockstep.hpp"

namespace {

/// Triangles of a size, in a box that is as long on each axis as stated.
template <class S>
std::vector<S> triangles(std::size_t n, double size, double const (&extent)[3], double from) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<S> all;
  for (std::size_t i = 0; i < n; ++i) {
    double const at[3] = {extent[0] * uniform(engine), extent[1] * uniform(engine), extent[2] * uniform(engine)};
    double const own = i % 10 == 0 ? 100 * size : size;  // a tenth are much larger
    for (int k = 0; k < 9; ++k) all.push_back(static_cast<S>(from + at[k % 3] + own * uniform(engine)));
  }
  return all;
}

template <class S, class Space>
void check(Space space, std::vector<S> const& vertices, S radius, double width, std::size_t budget) {
  auto const mesh = collide::triangle_soup(vertices.data(), vertices.size() / 9);
  collide::bucket options;
  options.cell_width = width;
  options.memory_budget = budget;
  collide::bucket::index<S> index;
  index.build(space, options, mesh);
  index.prepare(space, options, collide::spheres_xyz(vertices.data(), vertices.size() / 3, radius));
  auto const made = index.mesh_lookup();
  if (made.grid_count == 0) {
    CHECK(budget != 0);
    return;
  }
  CHECK(made.grid_count == 1);
  collide::detail::grid<S> const& g = made.grids[0];
  CHECK(g.serves(radius));
  CHECK(g.dilation >= radius);
  S longest = 0;
  for (int k = 0; k < 3; ++k) {
    S lower = std::numeric_limits<S>::infinity(), upper = -lower;
    for (std::size_t i = static_cast<std::size_t>(k); i < vertices.size(); i += 3) {
      lower = std::min(lower, vertices[i]);
      upper = std::max(upper, vertices[i]);
    }
    CHECK(g.lower[k] <= lower - radius);
    CHECK(g.upper[k] >= upper + radius);
    longest = std::max(longest, g.upper[k] - g.lower[k]);
  }
  CHECK(g.levels >= 1);
  CHECK(g.levels <= collide::detail::max_levels);
  std::uint32_t cells = 0;
  for (int l = 0; l < g.levels; ++l) {
    auto const& level = g.level[l];
    CHECK(level.first == cells);
    CHECK(level.width >= 95 * collide::detail::ieee_traits<S>::unit_roundoff * longest);
    CHECK(level.inverse_width == 1 / level.width);
    if (width > 0) CHECK(level.width >= static_cast<S>(width));
    std::uint64_t of_level = 1;
    for (int k = 0; k < 3; ++k) {
      CHECK((level.mask[k] & (level.mask[k] + 1)) == 0);  // a power of two less 1
      of_level *= std::min<std::uint64_t>(std::uint64_t{g.coordinate(level, g.upper[k], k)} + 1,
                                          std::uint64_t{level.mask[k]} + 1);
    }
    cells += static_cast<std::uint32_t>(of_level);
  }
  CHECK(g.cells == cells);
  if (g.levels == 2) {
    CHECK(g.level[0].width < g.level[1].width);
    CHECK(std::isinf(g.level[1].largest));
  } else {
    CHECK(std::isinf(g.level[0].largest));
  }
}

}  // namespace

TEST_CASE_TEMPLATE("plan: the grid holds the mesh and the reach, and its cells are no narrower than coordinates allow",
                   S, float, double) {
  double const extents[][3] = {{10, 10, 10}, {1000, 1, 0}, {1e-3, 1e6, 1}};
  for (auto const& extent : extents) {
    for (double from : {0., 1e4}) {
      for (double size : {1e-3, 1., 0.}) {
        auto const vertices = triangles<S>(300, size, extent, from);
        for (S radius : {S(0), S(0.1), S(50)}) {
          for (double width : {0., 0.01, 5.}) {
            for (std::size_t budget : {std::size_t{0}, std::size_t{100000}}) {
              check<S>(tests::lockstep<8, false>(), vertices, radius, width, budget);
              check<S>(collide::host(1), vertices, radius, width, budget);
            }
          }
        }
      }
    }
  }
}

TEST_CASE("plan: a triangle that one block would enter for long has cells of its own on a device") {
  for (std::size_t giants : {std::size_t{0}, std::size_t{1}}) {
    auto const scene = io::giants_scene(giants, 30000, 30000, 0);
    std::vector<float> const corners(scene.vertices.begin(), scene.vertices.end()),
        centres(scene.centres.begin(), scene.centres.end());
    tests::lockstep<8, false> space;
    collide::bucket::index<float> index;
    index.build(space, {}, collide::triangle_soup(corners.data(), corners.size() / 9));
    index.prepare(space, {},
                  collide::spheres_xyz(centres.data(), centres.size() / 3, static_cast<float>(scene.radius)));
    auto const made = index.mesh_lookup();
    REQUIRE(made.grid_count == 1);
    CHECK(made.grids[0].levels == (giants == 0 ? 1 : 2));
    CHECK(*made.total < 8 * 30000);
  }
}
