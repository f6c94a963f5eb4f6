/// The cells of paths.
#include <cstdint>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/broad/detail/grid/swept_cells.hpp>

#include "scenes.hpp"

TEST_CASE_TEMPLATE("swept cells: a path that leaves the grid comes through none but its cells", S, float, double) {
  collide::detail::grid<S> grid{};
  grid.levels = 1;
  for (int k = 0; k < 3; ++k) grid.upper[k] = 1;
  auto& level = grid.level[0];
  level.inverse_width = 10;
  for (auto& mask : level.mask) mask = (1u << 31) - 1;
  tests::dice dice(26);
  int cells = 0;
  for (int i = 0; i < 2000; ++i) {
    double const length = i % 2 == 0 ? 0.1 : 4;  // short paths are looked at as a whole
    auto const from = dice.in_cube(0.6), along = dice.in_cube(length);
    collide::vec3<S> const begin(S(from.x + 0.5), S(from.y + 0.5), S(from.z + 0.5)),
        step(S(along.x), S(along.y), S(along.z));
    collide::detail::swept_cells<S> const path(grid, level, begin, step);
    for (std::uint32_t k = 0; k < path.steps(); ++k) {
      auto const place = path.at(k);
      if (!place.is_cell) continue;
      ++cells;
      for (int axis = 0; axis < 3; ++axis) {
        if (place.cell[axis] > grid.coordinate(level, grid.upper[axis], axis)) FAIL("beyond the grid");
      }
    }
  }
  CHECK(cells > 2000);
}

TEST_CASE_TEMPLATE("swept cells: of moving spheres, a few bits tell what walking their paths does", S, float, double) {
  using collide::detail::swept_cells;
  collide::detail::grid<S> grid{};
  grid.levels = 1;
  auto& level = grid.level[0];
  level = {S(0.1), S(10), S(0), {7, (1u << 31) - 1, 3}, {8, 8 * 11}, 3};  // 10 cells wide: wrapped in x and z
  for (int k = 0; k < 3; ++k) grid.upper[k] = 1;
  tests::dice dice(27);
  std::vector<std::uint8_t> occupied((3 + 8 * 11 * 4) / 8 + 1);
  for (auto& byte : occupied) byte = static_cast<std::uint8_t>(1u << dice.integer(0, 7));
  std::uint32_t const total = 0;
  collide::detail::bucket_ref<S> lookup{{{}, nullptr}, &grid, 1, occupied.data(), nullptr, &total, nullptr, 0};
  auto const occupancy = lookup.occupancy();
  S const bad[] = {std::numeric_limits<S>::infinity(), -std::numeric_limits<S>::infinity(),
                   std::numeric_limits<S>::quiet_NaN()};
  int empty = 0, near_some = 0, unknown = 0, away = 0;
  for (int i = 0; i < 5000; ++i) {
    double const length = i % 20 == 0 ? 4 : i % 3 * 0.04;
    collide::detail::moving_pack<S, 4> batch;
    for (int k = 0; k < 4; ++k) {
      auto const from = dice.in_cube(0.7), along = dice.in_cube(length);
      batch.x[k] = S(from.x + 0.5), batch.y[k] = S(from.y + 0.5), batch.z[k] = S(from.z + 0.5);
      batch.dx[k] = S(along.x), batch.dy[k] = S(along.y), batch.dz[k] = S(along.z);
    }
    bool const is_bad = i % 50 == 7;
    if (is_bad) (i % 4 < 2 ? batch.x : batch.dz)[i % 3] = bad[i / 50 % 3];
    bool near[4], all_short = true;
    bool const known = occupancy.test_swept(batch, near);
    for (int k = 0; k < 4 && !is_bad; ++k) {
      bool const inside = swept_cells<S>::overlaps_slab(0, 1, batch.x[k], batch.dx[k]) &&
                          swept_cells<S>::overlaps_slab(0, 1, batch.y[k], batch.dy[k]) &&
                          swept_cells<S>::overlaps_slab(0, 1, batch.z[k], batch.dz[k]);
      swept_cells<S> const path(grid, level, batch.centre(k), batch.displacement(k));
      all_short =
          all_short &&
          (!inside || path.is_short(path.cell_box_of_path(grid, level, batch.centre(k), batch.displacement(k))));
      bool expected = false;
      for (std::uint32_t step = 0; inside && step < path.steps(); ++step) {
        auto const place = path.at(step);
        std::uint32_t const cell = level.row(place.cell[1], place.cell[2]) + (place.cell[0] & level.mask[0]);
        expected = expected || (place.is_cell && lookup.is_occupied(cell));
      }
      if (known && near[k] != expected) FAIL("sphere " << k << " of group " << i);
      away += inside ? 0 : 1;
      near_some += known && expected ? 1 : 0;
      empty += known && inside && !expected ? 1 : 0;
    }
    if (known != (all_short && !is_bad)) FAIL("group " << i);
    unknown += known ? 0 : 1;
  }
  CHECK(empty > 1000);
  CHECK(near_some > 1000);
  CHECK(away > 1000);
  CHECK(unknown > 200);
}
