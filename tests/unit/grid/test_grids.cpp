/// Grids that must not collapse, whatever the scene, the cell width and the memory.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/bucket.cuh>

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
    if (policy.memory_budget != 0 && c.broad == "bucket")
      CHECK(detector->memory().peak <= policy.memory_budget + 16 + list);
    tests::check_pairs(*detector, expected);
  }
}

/// The grid has not collapsed: its cells are no wider than `largest`. The scene must be one where narrow cells pay.
template <class S>
void check_width(tests::scene<S> const& made, double largest) {
  for (auto const& c : tests::compositions<S>()) {
    if (c.broad != "bucket") continue;
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

TEST_CASE_TEMPLATE("grids: the width that is asked for is the width in use", S, float, double) {
  auto const made = tests::lattice_scene<S>(24, 100, 100, 5);
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    for (double width : {0., 2., 6.}) {
      auto const detector = c.make({width, 0, 2});
      CHECK(detector->cell_width() == 0);  // nothing was built
      detector->build(made.mesh, mesh_form::indexed, S(1));
      detector->place(made.spheres, sphere_form::xyz_one);
      detector->count();
      if (c.broad != "bucket")
        CHECK(detector->cell_width() == 0);
      else if (width != 0)
        CHECK(detector->cell_width() == doctest::Approx(width));
      else
        CHECK(detector->cell_width() > 0);
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
