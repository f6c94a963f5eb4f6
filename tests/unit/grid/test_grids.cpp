/// Grids that must not collapse, whatever the scene, the cell width and the memory.
#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/bucket.cuh>
#include <collide/detail/grid/grid_ref.hpp>
#include <collide/detail/grid/swept_cells.hpp>

#include "checks.hpp"

using tests::mesh_form;
using tests::options;
using tests::sphere_form;

namespace {

template <class S>
void check_with(tests::scene<S> const& made, oracle::expectation const& expected, options const& policy) {
  for (auto const& c : tests::compositions<S>()) {
    if (c.broad == "all_pairs") continue;
    CAPTURE(c.name());
    CAPTURE(policy.cell_width);
    CAPTURE(policy.memory_budget);
    auto const detector = c.make(policy);
    detector->build(made.mesh, mesh_form::indexed);
    detector->place(made.spheres, sphere_form::xyz);
    CHECK((detector->count() >= expected.certain.size()));
    // two numbers of 8 bytes are the sink's own, and a list of undecided pairs, where there is one, the detector's
    std::size_t const list = detector->exact() ? 16 + (1024 + made.spheres.size()) * sizeof(collide::pair) : 0;
    if (policy.memory_budget != 0) CHECK(detector->memory().peak <= policy.memory_budget + 16 + list);
    tests::check_pairs(*detector, expected);
  }
}

/// The grid has not collapsed: its cells are no wider than `largest`.
template <class S>
void check_width(tests::scene<S> const& made, double largest) {
  for (auto const& c : tests::compositions<S>()) {
    if (c.broad == "all_pairs") continue;
    CAPTURE(c.name());
    auto const detector = c.make({});
    detector->build(made.mesh, mesh_form::indexed);
    detector->place(made.spheres, sphere_form::xyz_one);
    detector->count();
    CHECK(detector->cell_width() > 0);
    CHECK(detector->cell_width() <= largest);
  }
}

template <class S>
void check_with_budgets(tests::scene<S> const& made, double band) {
  auto const expected = made.expect(band);
  CHECK(expected.certain.size() > 10);
  for (double budget : {0., 1., 1e3, 1e4, 3e4, 1e5, 1e6, 1e8})
    check_with(made, expected, {0, static_cast<std::size_t>(budget), 2});
}

}  // namespace

TEST_CASE_TEMPLATE("grids: each pair exactly once, whatever the width of the cells", S, float, double) {
  auto const lattice = tests::lattice_scene<S>(21, 100, 100, 5);
  auto const exact = lattice.expect(0);
  tests::random_scene random;
  random.seed = 22;
  random.triangles = random.spheres = 100;
  random.triangle_size = 3;
  auto const soup = random.make<S>();
  auto const banded = soup.expect(1e-4);
  for (double width : {1e-30, 1e-6, 1e-3, 0.1, 0.25, 0.5, 1., 1.5, 2., 3.7, 8., 100., 1e6, 1e30}) {
    check_with(lattice, exact, {width, 0, 2});
    check_with(soup, banded, {width, 0, 2});
  }
  for (double budget : {3e4, 1e5, 1e7}) check_with(lattice, exact, {0.5, static_cast<std::size_t>(budget), 2});
}

TEST_CASE_TEMPLATE("grids: spheres and vertices exactly on the boundaries of cells, also at negative coordinates", S,
                   float, double) {
  for (double shift : {-1e6, -1024., -8., -0.5, 0., 0.5, 1024., 1e6}) {
    auto made = tests::lattice_scene<S>(23, 80, 80, 4);
    for (auto& x : made.mesh.vertices) x += static_cast<S>(shift);
    for (auto& x : made.spheres.centres) x += static_cast<S>(shift);
    auto const expected = made.expect(0);
    CAPTURE(shift);
    for (double width : {0.125, 0.5, 1., 2., 4.}) check_with(made, expected, {width, 0, 2});
  }
}

TEST_CASE_TEMPLATE("grids: triangles that follow each other, and one at the end that is alone", S, float, double) {
  for (int n : {1, 2, 3, 7, 50, 51}) {
    CAPTURE(n);
    tests::scene<S> made;
    for (int i = 0; i < n; ++i) {  // a row of squares, each of two triangles
      double const x = i / 2;
      if (i % 2 == 0) {
        made.mesh.add({{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}});
      } else {
        made.mesh.add({{x, 0, 0}, {x + 1, 1, 0}, {x, 1, 0}});
      }
    }
    tests::dice dice(static_cast<unsigned>(40 + n));
    double const last = (n - 1) / 2;
    for (int i = 0; i < 300; ++i) {
      made.spheres.add({last + dice.uniform(-1, 2), dice.uniform(-1, 2), dice.uniform(-1, 1)}, 0.5);
    }
    auto const expected = made.expect(1e-4);
    CHECK(expected.certain.size() > 30);
    for (double width : {0., 0.1, 0.3, 1.}) check_with(made, expected, {width, 0, 2});
  }
}

TEST_CASE_TEMPLATE("grids: a way that leaves the grid comes through none but its cells", S, float, double) {
  collide::detail::grid<S> grid{};
  grid.levels = 1;
  for (int k = 0; k < 3; ++k) grid.upper[k] = 1;
  auto& level = grid.level[0];
  level.inverse_width = 10;
  for (auto& mask : level.mask) mask = (1u << 31) - 1;
  tests::dice dice(26);
  int cells = 0;
  for (int i = 0; i < 2000; ++i) {
    double const length = i % 2 == 0 ? 0.1 : 4;  // short ways are looked at as a whole
    auto const from = dice.in_cube(0.6), along = dice.in_cube(length);
    collide::vec3<S> const begin(S(from.x + 0.5), S(from.y + 0.5), S(from.z + 0.5)),
        step(S(along.x), S(along.y), S(along.z));
    collide::detail::swept_cells<S> const way(grid, level, begin, step);
    for (std::uint32_t k = 0; k < way.steps(); ++k) {
      auto const place = way.at(k);
      if (!place.is_cell) continue;
      ++cells;
      for (int axis = 0; axis < 3; ++axis) {
        if (place.cell[axis] > grid.coordinate(level, grid.upper[axis], axis)) FAIL("beyond the grid");
      }
    }
  }
  CHECK(cells > 2000);
}

TEST_CASE_TEMPLATE("grids: of spheres that move, a few bits tell what walking their ways does", S, float, double) {
  using collide::detail::swept_cells;
  collide::detail::grid<S> grid{};
  grid.levels = 1;
  auto& level = grid.level[0];
  level = {S(10), S(0), {7, (1u << 31) - 1, 3}, {8, 8 * 11}, 3};  // 10 cells wide: wrapped in x and z
  for (int k = 0; k < 3; ++k) grid.upper[k] = 1;
  tests::dice dice(27);
  std::vector<std::uint8_t> occupied((3 + 8 * 11 * 4) / 8 + 1);
  for (auto& byte : occupied) byte = static_cast<std::uint8_t>(1u << dice.integer(0, 7));
  std::uint32_t const total = 0;
  collide::detail::bucket_ref<S> lookup{{{}, nullptr}, &grid, 1, occupied.data(), nullptr, &total, nullptr, 0};
  auto const marks = lookup.marks();
  S const bad[] = {std::numeric_limits<S>::infinity(), -std::numeric_limits<S>::infinity(),
                   std::numeric_limits<S>::quiet_NaN()};
  int empty = 0, near_some = 0, unknown = 0, away = 0;
  for (int i = 0; i < 5000; ++i) {
    double const length = i % 20 == 0 ? 4 : i % 3 * 0.04;
    collide::detail::moving_batch<S, 4> batch;
    for (int k = 0; k < 4; ++k) {
      auto const from = dice.in_cube(0.7), along = dice.in_cube(length);
      batch.x[k] = S(from.x + 0.5), batch.y[k] = S(from.y + 0.5), batch.z[k] = S(from.z + 0.5);
      batch.dx[k] = S(along.x), batch.dy[k] = S(along.y), batch.dz[k] = S(along.z);
    }
    bool const is_bad = i % 50 == 7;
    if (is_bad) (i % 4 < 2 ? batch.x : batch.dz)[i % 3] = bad[i / 50 % 3];
    bool near[4], all_short = true;
    bool const known = marks.test_swept(batch, near);
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

TEST_CASE_TEMPLATE("grids: the width that is asked for is the width in use", S, float, double) {
  auto const made = tests::lattice_scene<S>(24, 100, 100, 5);
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    for (double width : {0., 2., 6.}) {
      auto const detector = c.make({width, 0, 2});
      CHECK(detector->cell_width() == 0);  // nothing was built
      detector->build(made.mesh, mesh_form::indexed, S(1));
      if (c.broad == "all_pairs")
        CHECK(detector->cell_width() == 0);
      else if (width != 0)
        CHECK(detector->cell_width() == doctest::Approx(width));
      else
        CHECK(detector->cell_width() > 0);
    }
  }
}

/// The host, with cells as wide as those of a GPU.
struct wide_cells : collide::host {};

template <>
struct collide::bucket_tuning<wide_cells> : collide::device_bucket_tuning {};

TEST_CASE_TEMPLATE("grids: triangles of two sizes are of one level, and cells no wider than they must be", S, float,
                   double) {
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> uniform(0.5, 2);
  int of_one_level = 0;
  double widest = 0;
  for (int k = 0; k < 1000; ++k) {
    double const size = uniform(engine);
    std::vector<S> corners;
    for (int i = 0; i < 8; ++i) {
      auto const x = static_cast<S>(3 * size * i), y = static_cast<S>(i % 4 == 0 ? 1.3 * size : size);
      corners.insert(corners.end(), {x, S(0), S(0), x + y, S(0), S(0), x, y, S(0)});
    }
    wide_cells space;
    collide::bucket::index<S> index;
    index.build(space, collide::bucket{}, collide::triangle_soup(corners.data(), corners.size() / 9));
    index.prepare(space, collide::bucket{}, static_cast<S>(0.1 * uniform(engine)));
    auto const& grid = index.lookup().grids[0];
    double const largest = 1.3 * size + 2 * static_cast<double>(grid.dilation);
    of_one_level += grid.levels == 1;
    widest = std::max(widest, static_cast<double>(grid.width) / largest);
  }
  CHECK(of_one_level == 1000);
  CHECK(widest < 1);
}

TEST_CASE("grids: a part of a cell and what may be in it meet on all axes or not at all") {
  using collide::detail::cell_coverage;
  constexpr std::uint32_t first = cell_coverage::first, last = cell_coverage::last, before = cell_coverage::before;
  auto const everywhere = [&](int axis) {
    return cell_coverage::encode_query(first, last, (axis + 1) % 3) |
           cell_coverage::encode_query(first, last, (axis + 2) % 3);
  };
  auto const whole = [&](int axis) {
    return cell_coverage::encode_box(before, last, (axis + 1) % 3) |
           cell_coverage::encode_box(before, last, (axis + 2) % 3);
  };
  for (int axis = 0; axis < 3; ++axis) {
    CHECK((whole(axis) | cell_coverage::encode_box(before, last, axis)) == cell_coverage::full_box);
    CHECK((everywhere(axis) | cell_coverage::encode_query(first, last, axis)) == cell_coverage::full_query);
    for (std::uint32_t from = before; from <= last; ++from) {
      for (std::uint32_t to = std::max(from, first); to <= last; ++to) {
        std::uint32_t const part = whole(axis) | cell_coverage::encode_box(from, to, axis);
        CHECK(cell_coverage::overlaps(part, cell_coverage::full_query));
        CHECK(cell_coverage::starts_in_earlier_cell(part, cell_coverage::axis(axis)) == (from == before));
        CHECK_FALSE(cell_coverage::starts_in_earlier_cell(part, 0));
        for (std::uint32_t a = first; a <= last; ++a) {
          for (std::uint32_t b = a; b <= last; ++b) {
            std::uint32_t const place = everywhere(axis) | cell_coverage::encode_query(a, b, axis);
            CHECK(cell_coverage::overlaps(part, place) == (a <= to && b >= from));
            CHECK(cell_coverage::overlaps(cell_coverage::full_box, place));
          }
        }
      }
    }
  }
}

TEST_CASE_TEMPLATE("grids: entries contain what is in a triangle's dilated box, and little else", S, float, double) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  // the last two have fewer cells than their scenes, so that coordinates wrap
  for (double width : {0., 0.3, 2., 20., 0.02, 0.004}) {
    std::vector<S> corners;
    std::size_t const n = 200;
    for (std::size_t i = 0; i < n; ++i) {
      double const at[3] = {10 * uniform(engine) - 5, 10 * uniform(engine) + 100, 10 * uniform(engine) - 1000};
      for (int k = 0; k < 9; ++k) corners.push_back(static_cast<S>(at[k % 3] + uniform(engine)));
    }
    wide_cells space;
    collide::bucket options;
    options.cell_width = width;
    collide::bucket::index<S> index;
    auto const mesh = collide::triangle_soup(corners.data(), n);
    index.build(space, options, mesh);
    index.prepare(space, options, S(0.25));
    auto const& grid = index.lookup().grids[0];
    REQUIRE(grid.levels > 0);
    std::size_t inside = 0, listed = 0, passed = 0, wrong = 0;
    for (std::size_t i = 0; i < n; ++i) {
      collide::detail::aabb<S> const b = collide::detail::triangle_aabb_of(mesh[i]);
      auto const& level = grid.level_of(b);
      std::map<std::uint32_t, std::uint32_t> parts;
      grid.template each_cells<1>(b, 0, 1, [&](collide::detail::cell_ref const(&c)[1], std::uint32_t m) {
        if (m == 1) parts[c[0].number] = c[0].coverage;
      });
      for (int j = 0; j < 2000; ++j) {
        collide::vec3<S> p;
        bool in_box = true, in_grid = true;
        double beyond = 0;
        for (int k = 0; k < 3; ++k) {
          S const lower = b.lower[k] - grid.dilation, upper = b.upper[k] + grid.dilation;
          double const out = j % 2 == 0 ? 0 : 0.3;
          p[k] = static_cast<S>(lower + (static_cast<double>(upper) - lower) * ((1 + 2 * out) * uniform(engine) - out));
          if (j % 10 == 0) p[k] = j % 20 == 0 ? lower : upper;  // on its corners
          in_box = in_box && lower <= p[k] && p[k] <= upper;
          in_grid = in_grid && grid.lower[k] <= p[k] && p[k] <= grid.upper[k];
          beyond = std::max({beyond, static_cast<double>(lower) - p[k], static_cast<double>(p[k]) - upper});
        }
        if (!in_grid) continue;
        auto const place = grid.place_of(level, p);
        auto const found = parts.find(place.number);
        bool const meets =
            found != parts.end() && collide::detail::cell_coverage::overlaps(found->second, place.coverage);
        if (in_box) {
          ++inside;
          wrong += !meets;
        } else if (found != parts.end()) {
          ++listed;
          passed += meets;
          double const step = 2.01 / 16 / static_cast<double>(level.inverse_width);
          if (level.is_spread()) wrong += meets && beyond > step;
        }
      }
    }
    CAPTURE(width);
    CHECK(wrong == 0);
    CHECK(inside > 50 * n);
    if (width == 0) CHECK((listed > 10 * n && 4 * passed < listed));
  }
}

TEST_CASE_TEMPLATE("grids: triangles with bad values do not count", S, float, double) {
  auto made = tests::lattice_scene<S>(30, 100, 10, 5);
  for (auto& r : made.spheres.radii) r = 1;
  double const everything = 2 * (5 + 4 + 1);  // the width of the scene without the bad triangles
  double const nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  made.mesh.add({{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  made.mesh.add({{0, 0, 0}, {1, infinity, 0}, {0, 1, 0}});
  made.mesh.add({{0, 0, -infinity}, {1, nan, 0}, {0, 1, 0}});
  check_with(made, made.expect(0), {});
  check_width(made, everything);
}

TEST_CASE_TEMPLATE("grids: a soup with one triangle 1e6 times as large as the rest", S, float, double) {
  tests::random_scene random;
  random.seed = 25;
  random.triangle_size = 0.1;
  random.extent = 2;
  random.radius = 0.2;
  auto made = random.make<S>();
  made.mesh.add({{-1e5, -1e5, 0.3}, {1e5, -1e5, 0.3}, {0, 1e5, 0.3}});
  check_with_budgets(made, 1e-2);
  check_width(made, 5);
}

TEST_CASE_TEMPLATE("grids: two objects 1e6 radii apart", S, float, double) {
  tests::random_scene random;
  random.seed = 26;
  random.triangle_size = 0.1;
  random.extent = 2;
  random.radius = 0.2;
  random.triangles = random.spheres = 100;
  auto made = random.make<S>();
  random.offset = {2e5, -2e5, 2e5};
  auto const other = random.make<S>();
  for (std::size_t i = 0; i < other.mesh.size(); ++i) made.mesh.add(other.mesh[i]);
  for (std::size_t i = 0; i < other.spheres.size(); ++i)
    made.spheres.add(other.spheres[i].centre, other.spheres[i].radius);
  check_with_budgets(made, 1e-4);
  check_width(made, 5);
}

TEST_CASE_TEMPLATE("grids: all triangles in one cell", S, float, double) {
  tests::random_scene random;
  random.seed = 27;
  random.triangles = 1500;
  random.triangle_size = 0.001;
  random.extent = 0.01;
  random.radius = 0.5;
  random.spheres = 5;
  auto made = random.make<S>();
  random.spheres = 100;
  random.triangles = 0;
  random.extent = 4;
  auto const wide = random.make<S>();
  for (std::size_t i = 0; i < wide.spheres.size(); ++i)
    made.spheres.add(wide.spheres[i].centre, wide.spheres[i].radius);
  check_with_budgets(made, 1e-4);
  check_width(made, 5);
}

TEST_CASE_TEMPLATE("grids: radii spread 1000:1, and one sphere that holds everything", S, float, double) {
  tests::random_scene random;
  random.seed = 28;
  random.spread = 1000;
  random.radius = 5;
  random.triangles = 150;
  auto made = random.make<S>();
  made.spheres.add({0, 0, 0}, 1e4);
  made.spheres.add({3, 0, 0}, 0);
  check_with_budgets(made, 1e-4);
}

TEST_CASE_TEMPLATE("grids: a flat mesh, a line of triangles, and a single point", S, float, double) {
  tests::random_scene random;
  random.seed = 29;
  random.triangles = random.spheres = 150;
  auto const full = random.make<S>();
  for (int axes = 0; axes < 3; ++axes) {  // how many are left
    auto made = full;
    for (std::size_t i = 0; i < made.mesh.vertices.size(); ++i)
      if (static_cast<int>(i % 3) >= axes) made.mesh.vertices[i] = S(0.125);
    for (auto& r : made.spheres.radii) r = S(3);
    CAPTURE(axes);
    check_with(made, made.expect(1e-3), {});
  }
}
