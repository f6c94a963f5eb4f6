/// Surfaces whose triangles share whole edges, and those whose triangles do not.
#include <vector>

#include <doctest/doctest.h>

#include <collide/checks/validate_surface.hpp>

#include "nearest/point_cases.hpp"

namespace {

using collide::surface_problem;
using corner = std::vector<double>;

/// A rectangle of two triangles in a plane, along x and y, at a height.
template <class S>
void add_plate(std::vector<S>& soup, double x, double y, double to_x, double to_y, double height = 0) {
  for (corner const& c : {corner{x, y}, {to_x, y}, {to_x, to_y}, {x, y}, {to_x, to_y}, {x, to_y}})
    soup.insert(soup.end(), {S(c[0]), S(c[1]), S(height)});
}

template <class S>
collide::surface_report look_at(std::vector<S> const& soup, double tolerance) {
  return collide::validate_surface(collide::triangle_soup(soup.data(), soup.size() / 9), tolerance);
}

std::size_t count(collide::surface_report const& r, surface_problem p) { return r.where(p).size(); }

}  // namespace

TEST_CASE_TEMPLATE("validate_surface: surfaces that share their edges", S, float, double) {
  auto const ball = tests::icosphere<S>(3, 1, {100, 100, 100});
  CHECK(
      collide::validate_surface(
          collide::indexed_mesh(ball.vertices.data(), ball.vertices.size() / 3, ball.corners.data(), ball.size()), 1e-3)
          .ok());
  std::vector<S> grid;
  for (int i = 0; i < 9; ++i)
    for (int k = 0; k < 9; ++k) add_plate<S>(grid, i / 8., k / 8., (i + 1) / 8., (k + 1) / 8.);
  CHECK(look_at(grid, 0).ok());
  CHECK(look_at(grid, 1e-3).ok());
  CHECK(look_at(grid, 1e-3).message().empty());
  CHECK(collide::validate_surface(collide::mesh_view<S>(), 0).ok());
}

TEST_CASE_TEMPLATE("validate_surface: hanging nodes, cracks and overlaps, and where", S, float, double) {
  std::vector<S> hung;
  add_plate<S>(hung, -1, 0, 0, 1);
  add_plate<S>(hung, 0, 0, 1, 0.5);
  add_plate<S>(hung, 0, 0.5, 1, 1);
  auto const t = look_at(hung, 1e-6);
  CHECK(count(t, surface_problem::hanging_node) == 3);  // (0, 0.5) is a corner of three triangles at the edge x = 0
  CHECK(count(t, surface_problem::crack) == 0);
  CHECK(count(t, surface_problem::overlap) == 0);
  CHECK(t.where(surface_problem::hanging_node)[0] == collide::triangle_pair{0, 3});
  CHECK(t.message() ==
        "3 pair(s) of triangles where a corner hangs in an edge, the first are triangles number 0 and 3");

  for (double gap : {-1e-5, 1e-5}) {
    std::vector<S> cracked;
    add_plate<S>(cracked, -1, 0, 0, 1);
    add_plate<S>(cracked, gap, 0, 1, 1);
    CHECK(count(look_at(cracked, 1e-4), surface_problem::crack) > 0);
    CHECK(count(look_at(cracked, 1e-4), surface_problem::overlap) == 0);
    CHECK(count(look_at(cracked, 1e-6), surface_problem::crack) == 0);
    CHECK(look_at(cracked, 1e-6).ok() == (gap > 0));  // farther than the tolerance the plates overlap, or have nothing
  }

  for (double height : {0., 1e-5}) {
    std::vector<S> plates;
    add_plate<S>(plates, 0, 0, 1, 1);
    add_plate<S>(plates, 0.6, 0.3, 2, 2, height);
    CHECK(count(look_at(plates, 1e-4), surface_problem::overlap) == 3);
    CHECK(count(look_at(plates, 1e-6), surface_problem::overlap) == (height == 0 ? 3 : 0));
  }
  std::vector<S> twice;
  add_plate<S>(twice, 0, 0, 1, 1);
  add_plate<S>(twice, 0, 1, 1, 0);  // turned around, and cut the other way
  CHECK(count(look_at(twice, 1e-6), surface_problem::overlap) == 4);
}

TEST_CASE("validate_surface: errors, and triangles that are not there") {
  std::vector<double> soup;
  add_plate(soup, 0, 0, 1, 1);
  CHECK_THROWS_WITH_AS(look_at(soup, -1),
                       "collide: validate_surface: the tolerance is a length, not negative and finite", collide::error);
  soup[0] = std::numeric_limits<double>::quiet_NaN();
  CHECK(look_at(soup, 1e-6).ok());
}
