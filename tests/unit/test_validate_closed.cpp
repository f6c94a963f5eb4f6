/// Meshes that are closed and oriented, and the places where others are not.
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/checks/validate_closed.hpp>

#include "nearest/point_cases.hpp"

namespace {

using collide::seam_problem;

template <class S>
collide::seam_report validate_soup(std::vector<collide::triangle<S>> const& mesh) {
  std::vector<S> corners;
  for (auto const& t : mesh)
    for (auto const& v : {t.a, t.b, t.c}) corners.insert(corners.end(), {v.x(), v.y(), v.z()});
  return collide::validate_closed(collide::triangle_soup(corners.data(), mesh.size()));
}

std::size_t count(collide::seam_report const& r, seam_problem p) { return r.where(p).size(); }

}  // namespace

TEST_CASE_TEMPLATE("validate_closed: closed meshes, indexed and as soups", S, float, double) {
  auto const ball = tests::icosphere<S>(2, 1, {100, 100, 100});
  auto const indexed = collide::validate_closed(
      collide::indexed_mesh(ball.vertices.data(), ball.vertices.size() / 3, ball.corners.data(), ball.size()));
  CHECK(indexed.ok());
  CHECK(indexed.message().empty());
  CHECK(validate_soup(tests::triangles_of(ball)).ok());
  CHECK(validate_soup(tests::triangles_of(tests::unit_cube<S>())).ok());
  CHECK(collide::validate_closed(collide::mesh_view<S>()).ok());
}

TEST_CASE_TEMPLATE("validate_closed: what is wrong, and where", S, float, double) {
  auto const cube = tests::triangles_of(tests::unit_cube<S>());
  auto holed = cube;
  holed.pop_back();
  auto const open = validate_soup(holed);
  CHECK_FALSE(open.closed());
  CHECK_FALSE(open.oriented());
  CHECK(count(open, seam_problem::open_edge) == 3);
  CHECK(count(open, seam_problem::flipped_edge) == 0);
  auto const first = open.where(seam_problem::open_edge)[0];
  CHECK(open.message() == "3 open edge(s), of one triangle only, the first is edge " + std::to_string(first.edge) +
                              " of triangle number " + std::to_string(first.triangle));

  auto turned = cube;
  std::swap(turned[5].a, turned[5].b);
  auto const flipped = validate_soup(turned);
  CHECK(flipped.closed());
  CHECK_FALSE(flipped.oriented());
  CHECK_FALSE(flipped.ok());
  CHECK(count(flipped, seam_problem::flipped_edge) == 3);

  auto doubled = cube;
  doubled.push_back({cube[3].c, cube[3].a, cube[3].b});
  auto const twice = validate_soup(doubled);
  CHECK_FALSE(twice.closed());
  REQUIRE(count(twice, seam_problem::duplicate_face) == 1);
  CHECK(twice.where(seam_problem::duplicate_face)[0].triangle == 12);
  CHECK(count(twice, seam_problem::crowded_edge) == 9);
  CHECK(count(twice, seam_problem::open_edge) == 0);

  auto pair = cube;  // two cubes with an edge in common: closed, and oriented
  for (auto const& t : cube) {
    auto const moved = [](collide::vec3<S> const& v) { return collide::vec3<S>(v.x() + 1, v.y() + 1, v.z()); };
    pair.push_back({moved(t.a), moved(t.b), moved(t.c)});
  }
  auto const touching = validate_soup(pair);
  CHECK(touching.closed());
  CHECK(touching.oriented());
  CHECK_FALSE(touching.ok());
  CHECK(count(touching, seam_problem::crowded_edge) == 4);
}

// Subnormal numbers are not 0; what is degenerate or not finite is not there.
TEST_CASE_TEMPLATE("validate_closed: zeros of either sign, and triangles that are none", S, float, double) {
  auto mesh = tests::triangles_of(tests::unit_cube<S>());
  for (auto* const v : {&mesh[0].a, &mesh[4].b, &mesh[7].c})
    for (int k = 0; k < 3; ++k)
      if ((*v)[k] == 0) (*v)[k] = S(-0.0);
  CHECK(validate_soup(mesh).ok());
  mesh.push_back({{5, 5, 5}, {5, 5, 5}, {6, 5, 5}});
  mesh.push_back({{5, 5, 5}, {std::numeric_limits<S>::quiet_NaN(), 5, 5}, {6, 5, 5}});
  CHECK(validate_soup(mesh).ok());
  for (int k = 0; k < 3; ++k)
    if (mesh[0].a[k] == 0) mesh[0].a[k] = std::numeric_limits<S>::denorm_min();
  CHECK_FALSE(validate_soup(mesh).closed());
}

TEST_CASE("validate_closed: a corner that does not exist") {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  unsigned const triangles[] = {0, 1, 3};
  CHECK_THROWS_WITH(collide::validate_closed(collide::indexed_mesh(vertices, 3, triangles, 1)),
                    "collide: validate_closed: triangle number 0 has a corner that is not a vertex of the mesh");
}
