/// Where meshes cut themselves: all pairs against the oracle.
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/checks/self_intersections.hpp>

#include "nearest/point_cases.hpp"

namespace {

template <class S>
using triangles = std::vector<collide::triangle<S>>;

template <class S>
std::vector<collide::triangle_pair> found_in(triangles<S> const& mesh, int threads = 1) {
  std::vector<S> corners;
  for (auto const& t : mesh)
    for (auto const& v : {t.a, t.b, t.c}) corners.insert(corners.end(), {v.x(), v.y(), v.z()});
  return collide::self_intersections(collide::triangle_soup(corners.data(), mesh.size()), collide::host(threads));
}

template <class S>
std::vector<collide::triangle_pair> expected_in(triangles<S> const& mesh) {
  std::vector<collide::triangle_pair> all;
  for (collide::id i = 0; i < mesh.size(); ++i)
    for (collide::id k = i + 1; k < mesh.size(); ++k)
      if (oracle::meet(tests::to_oracle(mesh[i]), tests::to_oracle(mesh[k]))) all.push_back({i, k});
  return all;
}

template <class S>
void add(triangles<S>& to, triangles<S> const& mesh, collide::vec3<S> const& by) {
  for (auto const& t : mesh) to.push_back({t.a + by, t.b + by, t.c + by});
}

}  // namespace

TEST_CASE_TEMPLATE("self_intersections: closed meshes do not cut themselves, unless they do", S, float, double) {
  for (double const offset : {0.0, 1e5}) {
    auto const ball = tests::icosphere<S>(2, 1, {offset, offset, offset});
    CHECK(collide::self_intersections(
              collide::indexed_mesh(ball.vertices.data(), ball.vertices.size() / 3, ball.corners.data(), ball.size()))
              .empty());
    CHECK(found_in(tests::triangles_of(ball)).empty());
    auto pair = tests::triangles_of(tests::icosphere<S>(1, 1, {offset, offset, offset}));
    add(pair, triangles<S>(pair), {S(0.5), S(0.25), S(0.125)});
    auto const expected = expected_in(pair);
    CHECK(expected.size() > 20);
    CHECK(found_in(pair) == expected);
    CHECK(found_in(pair, 4) == expected);
  }
  auto const cube = tests::triangles_of(tests::unit_cube<S>());
  CHECK(found_in(cube).empty());
  auto beside = cube;  // they have a side in common: two triangles of it are there twice, or overlap
  add(beside, cube, {1, 0, 0});
  CHECK(found_in(beside) == expected_in(beside));
  CHECK_FALSE(found_in(beside).empty());
  auto at_corner = cube;
  add(at_corner, cube, {1, 1, 1});
  CHECK(found_in(at_corner).empty());
  auto touching = cube;  // a corner of each is on no corner of the other
  add(touching, cube, {S(0.5), S(0.5), 1});
  CHECK(found_in(touching) == expected_in(touching));
  CHECK_FALSE(found_in(touching).empty());
}

TEST_CASE_TEMPLATE("self_intersections: octahedra of small integers, needles and giants", S, float, double) {
  tests::dice roll(5);
  std::size_t pairs = 0;
  for (int i = 0; i < 40; ++i) {
    collide::vec3<S> v[6];
    for (auto& p : v) p = {S(roll.integer(-3, 3)), S(roll.integer(-3, 3)), S(roll.integer(-3, 3))};
    triangles<S> mesh;
    for (int k = 0; k < 8; ++k) mesh.push_back({v[k & 1], v[2 + (k >> 1 & 1)], v[4 + (k >> 2)]});
    auto const expected = expected_in(mesh);
    CHECK(found_in(mesh) == expected);
    pairs += expected.size();
  }
  CHECK(pairs > 100);
  triangles<S> soup;
  for (int i = 0; i < 150; ++i) {
    auto const at = tests::from_oracle<S>(roll.in_cube(1)), along = tests::from_oracle<S>(roll.in_cube(1));
    auto const aside = tests::from_oracle<S>(roll.in_cube(i % 2 == 0 ? 0.003 : 0.3));
    soup.push_back({at, at + along, at + aside});
  }
  soup.push_back({{-9, -9, 0}, {9, -9, 0}, {0, 9, S(0.1)}});
  soup.push_back(soup[7]);
  auto const expected = expected_in(soup);
  CHECK(expected.size() > 100);
  CHECK(found_in(soup) == expected);
  CHECK(found_in(soup, 3) == expected);
}

TEST_CASE_TEMPLATE("self_intersections: what is not there, zeros of either sign, and extreme numbers", S, float,
                   double) {
  constexpr S nan = std::numeric_limits<S>::quiet_NaN(), tiny = std::numeric_limits<S>::denorm_min(),
              most = std::numeric_limits<S>::max();
  CHECK(collide::self_intersections(collide::mesh_view<S>()).empty());
  triangles<S> mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
  mesh.push_back({{1, 1, -1}, {1, 1, 1}, {1, 1, 3}});  // has no area
  mesh.push_back({{1, 1, -1}, {1, nan, 1}, {2, 1, 3}});
  CHECK(found_in(mesh).empty());
  mesh.push_back({{S(-0.0), 0, 0}, {0, S(-0.0), 1}, {-1, -1, 0}});  // shares a corner
  CHECK(found_in(mesh).empty());
  mesh[3].a = {tiny, tiny, 0};  // does not
  CHECK(found_in(mesh) == std::vector<collide::triangle_pair>{{0, 3}});
  mesh.push_back({{-most, S(0.5), -most}, {most, S(0.5), -most}, {0, S(0.5), most}});
  CHECK(found_in(mesh) == expected_in(mesh));
  CHECK(found_in(mesh).size() == 2);
}

TEST_CASE("self_intersections: a corner that does not exist") {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  unsigned const triangles[] = {0, 1, 3};
  CHECK_THROWS_WITH(collide::self_intersections(collide::indexed_mesh(vertices, 3, triangles, 1)),
                    "collide: self_intersections: triangle number 0 has a corner that is not a vertex of the mesh");
}
