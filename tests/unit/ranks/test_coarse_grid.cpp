/// The coarse grid over all ranks' triangles.
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/ranks/detail/rank_map.hpp>

#include "ranks/boxes.hpp"

using collide::detail::aabb;
using collide::detail::coarse_grid;
using tests::box_at, tests::overlap;

namespace {

std::vector<std::size_t> cells_of(coarse_grid const& grid, aabb<double> const& box) {
  std::vector<std::size_t> cells;
  grid.for_each_cell(box, [&](std::size_t cell) { cells.push_back(cell); });
  return cells;
}

/// True if a cell is another one, or contains it.
bool contains(std::size_t outer, std::size_t inner) {
  while (inner > outer) inner = coarse_grid::parent_of(inner);
  return inner == outer;
}

}  // namespace

TEST_CASE("coarse grid: levels of 1, 8, 64, ... cells, each with its parent") {
  CHECK(coarse_grid::size() == 1 + 8 + 64 + 512 + 4096 + 32768);
  std::vector<int> children(coarse_grid::size(), 0);
  for (std::size_t cell = 1; cell < coarse_grid::size(); ++cell) ++children[coarse_grid::parent_of(cell)];
  for (std::size_t cell = 0; cell < coarse_grid::size(); ++cell)
    CHECK(children[cell] == (cell < coarse_grid::first_of(coarse_grid::finest) ? 8 : 0));
}

TEST_CASE("coarse grid: of two boxes that share a point, one has a cell that is in one of the other") {
  coarse_grid grid;
  grid.build(collide::one_rank(), box_at(1, 2, 3, 10));
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-14, 14), size(-6, 4);
  int shared = 0;
  bool is_right = true;
  for (int i = 0; i < 100000; ++i) {
    auto const a = box_at(1 + uniform(engine), 2 + uniform(engine), 3 + uniform(engine), std::exp2(size(engine))),
               b = box_at(1 + uniform(engine), 2 + uniform(engine), 3 + uniform(engine), std::exp2(size(engine)));
    CHECK(grid.meets(a) == overlap(a, grid.bounds()));
    if (!grid.meets(a) || !grid.meets(b)) continue;
    auto const of_a = cells_of(grid, a), of_b = cells_of(grid, b);
    is_right = is_right && of_a.size() <= 8 && of_b.size() <= 8;
    if (!overlap(a, b)) continue;
    ++shared;
    bool found = false;
    for (std::size_t p : of_a) {
      for (std::size_t q : of_b) found = found || contains(p, q) || contains(q, p);
    }
    is_right = is_right && found;
  }
  CHECK(shared > 5000);
  CHECK(is_right);
}

TEST_CASE("coarse grid: places on the curve are in the cells of the finest level") {
  coarse_grid grid;
  grid.build(collide::one_rank(), box_at(0, 0, 0, 1));
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    auto const point = box_at(uniform(engine), uniform(engine), uniform(engine), 0);
    CHECK(grid.place_at(point) < coarse_grid::places);
    CHECK(cells_of(grid, point) ==
          std::vector<std::size_t>{coarse_grid::first_of(coarse_grid::finest) + grid.place_at(point)});
  }
  CHECK(grid.place_at(aabb<double>::empty()) == 0);
  CHECK(!grid.meets(aabb<double>::empty()));
}

TEST_CASE("coarse grid: a mesh that is flat, a point, or none") {
  auto flat = box_at(0, 0, 0, 1);
  flat.lower[2] = flat.upper[2] = 5;
  for (auto const& mesh : {flat, box_at(3, 3, 3, 0), box_at(0, 0, 0, std::numeric_limits<double>::max() / 2)}) {
    coarse_grid grid;
    grid.build(collide::one_rank(), mesh);
    CHECK(grid.meets(mesh));
    CHECK(!cells_of(grid, mesh).empty());
    CHECK(grid.place_at(mesh) < coarse_grid::places);
  }
  coarse_grid none;
  none.build(collide::one_rank(), aabb<double>::empty());
  CHECK(!none.meets(flat));
}

TEST_CASE_TEMPLATE("coarse grid: the box of a path has the sphere at all times; what touches nothing has none", S,
                   float, double) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto const vector = [&](double size) {
    return collide::vec3<S>(S(size * uniform(engine)), S(size * uniform(engine)), S(size * uniform(engine)));
  };
  bool is_right = true;
  for (int i = 0; i < 10000; ++i) {
    collide::sphere<S> const s{vector(100), S(std::abs(uniform(engine)))};
    auto const along = vector(10);
    auto const box = collide::detail::reach_of(s, along, 1.);
    for (double t : {0., 0.3, 1.}) {
      for (int k = 0; k < 3; ++k) {
        double const at = double(s.centre[k]) + t * double(along[k]);
        is_right = is_right && box.lower[k] <= at - double(s.radius) && box.upper[k] >= at + double(s.radius);
      }
    }
  }
  CHECK(is_right);
  constexpr S nan = std::numeric_limits<S>::quiet_NaN();
  collide::vec3<S> const origin(0, 0, 0);
  CHECK(collide::detail::reach_of(collide::sphere<S>{origin, S(-1)}, origin, 1.).is_empty());
  CHECK(collide::detail::reach_of(collide::sphere<S>{origin, nan}, origin, 1.).is_empty());
  CHECK(collide::detail::reach_of(collide::sphere<S>{{0, nan, 0}, S(1)}, origin, 1.).is_empty());
  CHECK(collide::detail::reach_of(collide::sphere<S>{origin, S(1)}, {0, 0, nan}, 1.).is_empty());
}
