/// Grids that must not collapse, whatever the scene, the cell width and the memory.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
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

/// The grid has not collapsed: its cells are no wider than `largest`. The scene must be one where narrow cells pay.
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
  level = {S(0.1), S(10), S(0), {7, (1u << 31) - 1, 3}, {8, 8 * 11}, 3};  // 10 cells wide: wrapped in x and z
  for (int k = 0; k < 3; ++k) grid.upper[k] = 1;
  tests::dice dice(27);
  std::vector<std::uint8_t> occupied((3 + 8 * 11 * 4) / 8 + 1);
  for (auto& byte : occupied) byte = static_cast<std::uint8_t>(1u << dice.integer(0, 7));
  std::uint32_t const total = 0;
  collide::detail::bucket_ref<S> lookup{{{}, nullptr}, &grid, 1, occupied.data(), nullptr, &total, nullptr, 0};
  auto const marks = lookup.occupancy();
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

/// The host, where spheres look for triangles as on a GPU.
struct wide_cells : collide::host {};

template <>
struct collide::bucket_tuning<wide_cells> : collide::device_bucket_tuning {};

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

namespace {

struct point {
  double x, y, z;
};
point operator-(point const& p, point const& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
double dot(point const& p, point const& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
point cross(point const& p, point const& q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

double distance_of_segment(point const& p, point const& a, point const& b) {
  point const ab = b - a;
  double const length = dot(ab, ab), t = length > 0 ? std::clamp(dot(p - a, ab) / length, 0., 1.) : 0;
  point const d = p - point{a.x + t * ab.x, a.y + t * ab.y, a.z + t * ab.z};
  return std::sqrt(dot(d, d));
}

template <class S>
double distance(point const& p, collide::triangle<S> const& t) {
  auto const wide = [](collide::vec3<S> const& v) { return point{double(v[0]), double(v[1]), double(v[2])}; };
  point const a = wide(t.a), b = wide(t.b), c = wide(t.c), n = cross(b - a, c - a);
  double least = std::min({distance_of_segment(p, a, b), distance_of_segment(p, b, c), distance_of_segment(p, c, a)});
  bool const inside =
      dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 && dot(cross(a - c, p - c), n) >= 0;
  if (inside && dot(n, n) > 0) least = std::min(least, std::abs(dot(p - a, n)) / std::sqrt(dot(n, n)));
  return least;
}

}  // namespace

TEST_CASE_TEMPLATE("grids: a triangle is in the cells of all centres within its reach, and in few others", S, float,
                   double) {
  using collide::detail::cell_coverage;
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  // thick, slivers, large, flat in a plane between cells, points; in the last two grids coordinates wrap
  double const shapes[][3] = {{1, 1, 1}, {1, 1, 0.001}, {9, 9, 0.01}, {6, 6, 0}, {0.001, 0.001, 0.001}, {0, 0, 0}};
  for (double width : {0., 0.3, 0.05, 2., 20., 0.02, 0.004}) {
    for (auto const& shape : shapes) {
      std::vector<S> corners;
      std::size_t const n = 60;
      for (std::size_t i = 0; i < n; ++i) {
        double const at[3] = {5 * uniform(engine), 5 * uniform(engine) + 100, 5 * uniform(engine) - 1000};
        double const along[3] = {uniform(engine), uniform(engine), uniform(engine)};
        double const turn[3] = {uniform(engine), uniform(engine), uniform(engine)};
        for (int c = 0; c < 3; ++c) {
          double const u = shape[0] * (c - 1), v = c == 1 ? shape[2] : 0;
          for (int k = 0; k < 3; ++k) {
            bool const flat = shape[2] == 0 && k == static_cast<int>(i % 3);
            double const free = shape[0] == shape[2] ? shape[0] * uniform(engine) : u * along[k] + v * turn[k];
            corners.push_back(static_cast<S>(flat ? std::round(at[k]) : at[k] + free));
          }
        }
      }
      wide_cells space;
      collide::bucket options;
      options.cell_width = width;
      collide::bucket::index<S> index;
      auto const mesh = collide::triangle_soup(corners.data(), n);
      index.build(space, options, mesh);
      S const radius = S(0.25);
      index.prepare(space, options, radius);
      auto const& grid = index.lookup().grids[0];
      REQUIRE(grid.levels > 0);
      std::size_t within = 0, missing = 0, twice = 0, far = 0, listed = 0, covered_wrongly = 0;
      for (std::size_t i = 0; i < n; ++i) {
        collide::triangle<S> const t = mesh[i];
        auto const b = collide::detail::aabb_of(t);
        auto const& level = grid.level_of(b);
        collide::detail::triangle_cells<S> const cells(grid, level, b);
        std::map<std::uint32_t, std::uint32_t> parts;
        std::size_t entries = 0;
        auto const enter = [&](std::uint32_t y, std::uint32_t z, std::uint32_t first, std::uint32_t last) {
          for (std::uint32_t x = first; x <= last; ++x) {
            auto const cell = cells.at(x, y, z);
            parts[cell.number] = cell.coverage;
            ++entries;
            if (!level.is_spread()) continue;
            // no farther from the triangle than the cell is wide on its diagonal, and the reach
            double const w = static_cast<double>(level.width);
            point const middle{static_cast<double>(grid.lower[0]) + (x + 0.5) * w,
                               static_cast<double>(grid.lower[1]) + (y + 0.5) * w,
                               static_cast<double>(grid.lower[2]) + (z + 0.5) * w};
            far += distance(middle, t) > 1.8 * (static_cast<double>(radius) + w) + 1e-3 ? 1 : 0;
          }
        };
        auto const& r = cells.range();
        if (cells.is_small()) {
          for (std::uint32_t z = r.lower[2]; z <= r.upper[2]; ++z) {
            for (std::uint32_t y = r.lower[1]; y <= r.upper[1]; ++y) enter(y, z, r.lower[0], r.upper[0]);
          }
        } else {
          for (std::uint32_t k = 0; k < cells.slabs(); ++k) cells.each_run(k, t, enter);
        }
        std::set<std::uint32_t> ranged;
        std::size_t of_ranges = 0;
        collide::detail::each_range(
            grid, b, [&] { return t; },
            [&](std::uint32_t first, std::uint32_t count) {
              of_ranges += count;
              for (std::uint32_t k = 0; k < count; ++k) ranged.insert(first + k);
            });
        listed += entries;
        twice += entries - parts.size() + (of_ranges - ranged.size());
        for (int j = 0; j < 300; ++j) {
          double const u = std::abs(uniform(engine)), v = (1 - u) * std::abs(uniform(engine)), w = 1 - u - v;
          double direction[3] = {uniform(engine), uniform(engine), uniform(engine)};
          double const length = std::hypot(direction[0], direction[1], direction[2]) + 1e-9;
          double const away = static_cast<double>(radius) * (j % 3 == 0 ? 1 : std::abs(uniform(engine)));
          collide::vec3<S> p;
          for (int k = 0; k < 3; ++k) {
            bool const on_axis = j % 5 == 0;  // the farthest on one axis
            double const part = on_axis ? (k == j % 3 ? std::copysign(1., direction[k]) : 0.) : direction[k] / length;
            p[k] = static_cast<S>(u * static_cast<double>(t.a[k]) + v * static_cast<double>(t.b[k]) +
                                  w * static_cast<double>(t.c[k]) + away * part);
          }
          if (distance({double(p[0]), double(p[1]), double(p[2])}, t) > static_cast<double>(radius)) continue;
          ++within;
          auto const place = grid.cell_at(level, p);
          auto const found = parts.find(place.number);
          missing += found == parts.end() ? 1 : 0;
          missing += ranged.count(place.number) == 0 ? 1 : 0;
          covered_wrongly += found != parts.end() && !cell_coverage::overlaps(found->second, place.coverage) ? 1 : 0;
        }
      }
      CAPTURE(width);
      CAPTURE(shape[0]);
      CAPTURE(shape[2]);
      CHECK(missing == 0);
      CHECK(covered_wrongly == 0);
      CHECK(twice == 0);
      CHECK(far == 0);
      CHECK(within > 50 * n);
      CHECK(listed >= n);
    }
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
  check_width(made, 1.02 * everything);
}

TEST_CASE_TEMPLATE("grids: a soup with one triangle 1e6 times as large as the rest", S, float, double) {
  tests::random_scene random;
  random.seed = 25;
  random.triangle_size = 0.1;
  random.extent = 2;
  random.radius = 0.2;
  auto const add_giant = [](tests::scene<S> made) {
    made.mesh.add({{-1e5, -1e5, 0.3}, {1e5, -1e5, 0.3}, {0, 1e5, 0.3}});
    return made;
  };
  check_with_budgets(add_giant(random.make<S>()), 1e-2);
  random.triangles = 3000, random.spheres = 5000;
  check_width(add_giant(random.make<S>()), 5);
}

TEST_CASE_TEMPLATE("grids: two objects 1e6 radii apart", S, float, double) {
  tests::random_scene random;
  random.seed = 26;
  random.triangle_size = 0.1;
  random.extent = 2;
  random.radius = 0.2;
  auto const two_objects = [](tests::random_scene random) {
    auto made = random.make<S>();
    random.offset = {2e5, -2e5, 2e5};
    auto const other = random.make<S>();
    for (std::size_t i = 0; i < other.mesh.size(); ++i) made.mesh.add(other.mesh[i]);
    for (std::size_t i = 0; i < other.spheres.size(); ++i)
      made.spheres.add(other.spheres[i].centre, other.spheres[i].radius);
    return made;
  };
  random.triangles = random.spheres = 100;
  check_with_budgets(two_objects(random), 1e-4);
  random.triangles = 3000, random.spheres = 5000;
  check_width(two_objects(random), 5);
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
