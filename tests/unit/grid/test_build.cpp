/// The entries of cells, against the cells of each triangle.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <collide/broad/detail/grid/triangle_cells.hpp>
#include <collide/bucket.cuh>

#include "execution/lockstep.hpp"
#include "random_triangles.hpp"

namespace {

/// Triangles from small to large against the cells, and one that is not finite.
template <class S>
std::vector<S> triangles(std::size_t n) {
  auto all =
      tests::random_triangles<S>(n, {9, 5, 1}, [](std::size_t, auto const& draw) { return std::exp2(3 * draw()); });
  all[9 * (n / 2)] = std::numeric_limits<S>::quiet_NaN();
  return all;
}

/// A triangle in a cell, and the part of the cell that it covers.
using entry = std::pair<collide::id, std::uint32_t>;

/// The triangles that the cells of a grid should list.
template <class S>
std::map<std::uint32_t, std::vector<entry>> expected_entries(collide::detail::grid<S> const& grid,
                                                             collide::mesh_view<S> const& mesh) {
  std::map<std::uint32_t, std::vector<entry>> all;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    auto const box = collide::detail::aabb_of(mesh[i]);
    if (box.is_empty()) continue;
    collide::detail::triangle_cells<S> const cells(grid, grid.level_of(box), box);
    auto const enter = [&](std::uint32_t y, std::uint32_t z, std::uint32_t first, std::uint32_t last) {
      for (std::uint32_t x = first; x <= last; ++x) {
        auto const cell = cells.at(x, y, z);
        all[cell.number].emplace_back(static_cast<collide::id>(i), cell.coverage);
      }
    };
    auto const& r = cells.range();
    if (cells.is_small()) {
      for (std::uint32_t z = r.lower[2]; z <= r.upper[2]; ++z) {
        for (std::uint32_t y = r.lower[1]; y <= r.upper[1]; ++y) enter(y, z, r.lower[0], r.upper[0]);
      }
    } else {
      for (std::uint32_t k = 0; k < cells.slabs(); ++k) cells.each_run(k, mesh[i], enter);
    }
  }
  return all;
}

template <class S, class Space>
void check(Space space, std::vector<S> const& vertices, std::vector<S> const& radii, double width) {
  auto const mesh = collide::triangle_soup(vertices.data(), vertices.size() / 9);
  std::vector<S> const centres(3 * radii.size());
  collide::bucket options;
  options.cell_width = width;
  collide::bucket::index<S> index;
  index.build(space, options, mesh);
  index.prepare(space, options, collide::spheres_xyz(centres.data(), radii.size(), radii.data()));
  auto const made = index.mesh_lookup();
  REQUIRE(made.grid_count > 0);
  std::uint64_t total = 0;
  std::vector<bool> taken(made.capacity);
  bool is_right = true, is_shared = false;
  for (int g = 0; g < made.grid_count; ++g) {
    auto expected = expected_entries(made.grids[g], mesh);
    std::uint32_t const first = made.grids[g].level[0].first;
    for (std::uint32_t c = first; c < first + made.grids[g].cells; ++c) {
      auto const list = made.lists[c];
      std::vector<entry> found;
      for (std::uint32_t slot = list.end - list.count; slot < list.end; ++slot) {
        found.emplace_back(made.entries[slot].triangle, made.entries[slot].coverage);
        is_shared = is_shared || taken[slot];
        taken[slot] = true;
      }
      std::sort(found.begin(), found.end());
      is_right = is_right && found == expected[c] && made.is_occupied(c) == !found.empty();
      total += found.size();
    }
  }
  CHECK(is_right);
  CHECK(!is_shared);
  CHECK(total == *made.total);
  CHECK(total >= (width > 0 && width < 1 ? 5 : 1) * mesh.size() - 1);
}

}  // namespace

TEST_CASE_TEMPLATE("build: each cell lists the triangles that meet it, each once", S, float, double) {
  auto const vertices = triangles<S>(200);
  for (double width : {0., 0.5, 4.}) {
    for (auto const& radii : {std::vector<S>{S(0.1)}, std::vector<S>{S(0.01), S(0.1), S(2)}}) {
      check<S>(tests::lockstep<8, false>(), vertices, radii, width);
      check<S>(tests::lockstep<8, true>(), vertices, radii, width);
    }
  }
}
