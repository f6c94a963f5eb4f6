/// Winding numbers of closed meshes, of open ones and of soups, and their errors.
#include <cmath>
#include <limits>
#include <vector>

#include <collide/core/error.hpp>
#include <collide/exact/detail/numeric/elementary.hpp>

#include "compared.hpp"
#include "execution/lockstep.hpp"
#include "nearest/winding_queries.hpp"

using tests::winding_of;

TEST_CASE("angles: those of the standard library") {
  tests::dice roll(1);
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    double const size = std::pow(10, roll.uniform(-20, 20)), y = size * roll.uniform(-1, 1), x = roll.uniform(-1, 1);
    worst = std::max(worst, std::abs(collide::detail::angle_of(y, x) - std::atan2(y, x)));
  }
  CHECK(worst < 0x1p-50);
  CHECK(collide::detail::angle_of(0, 0) == 0);
  CHECK(collide::detail::angle_of(0, -1) == std::acos(-1.0));
  CHECK(collide::detail::angle_of(-1, 0) == -std::acos(0.0));
}

TEST_CASE_TEMPLATE("winding numbers: whole around closed meshes, within their errors", S, float, double) {
  for (double const offset : {0.0, 1e5}) {
    tests::dice roll(2);
    auto const mesh = tests::triangles_of(tests::icosphere<S>(1, 1, {offset, offset, offset}));
    std::vector<oracle::triangle> exact;
    for (auto const& t : mesh) exact.push_back(tests::to_oracle(t));
    std::vector<collide::vec3<S>> points;
    for (int i = 0; i < 200; ++i) {
      auto const p = roll.in_cube(2);
      points.push_back(tests::from_oracle<S>({offset + p.x, offset + p.y, offset + p.z}));
      points.push_back(tests::point_at_surface(mesh, roll, 1));
    }
    auto const found = winding_of(mesh, points);
    int sure = 0, wrong = 0, touched = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      bool on_it = false;
      for (auto const& t : exact) on_it = on_it || oracle::hit(t, {tests::to_oracle(points[i]), 0});
      touched += on_it;
      if (on_it) continue;  // its winding number is none of these
      double const whole = oracle::inside(exact, tests::to_oracle(points[i])) ? 1 : 0;
      wrong += !(std::abs(double(found[i].value) - whole) <= double(found[i].error));
      sure += found[i].error < S(1e-3);
      if (found[i].error < S(1e-3))
        tests::compared<S>("winding number, where its `error` is below 1e-3", "1 inside, 0 outside",
                           double(found[i].value), whole);
    }
    CHECK(wrong == 0);
    CHECK(sure > 150);
    CHECK(touched < 300);
  }
}

TEST_CASE_TEMPLATE("winding numbers: holes, doubled meshes, and what is not finite", S, float, double) {
  auto cube = tests::triangles_of(tests::unit_cube<S>());
  std::vector<collide::vec3<S>> const middle{{S(0.5), S(0.5), S(0.5)}, {3, 0, 0}};
  auto doubled = cube;
  doubled.insert(doubled.end(), cube.begin(), cube.end());
  CHECK(winding_of(doubled, middle)[0].value == doctest::Approx(2));
  auto holed = cube;
  holed.erase(holed.begin(), holed.begin() + 2);  // one side of six
  CHECK(winding_of(holed, middle)[0].value == doctest::Approx(5.0 / 6));
  CHECK(std::abs(winding_of(holed, middle)[1].value) < S(0.1));
  holed.push_back({{0, 0, 0}, {std::numeric_limits<S>::infinity(), 0, 0}, {0, 1, 0}});
  CHECK(winding_of<collide::bvh>(holed, middle)[0].value == doctest::Approx(5.0 / 6));
  CHECK(std::isnan(winding_of(cube, {{std::numeric_limits<S>::quiet_NaN(), 0, 0}})[0].value));
  S const large = std::numeric_limits<S>::max() / 4;
  for (auto& t : cube) t = {t.a * large, t.b * large, t.c * large};
  CHECK(winding_of(cube, {{large / 2, large / 2, large / 2}})[0].value == doctest::Approx(1));
}

TEST_CASE_TEMPLATE("winding numbers: of a tree, within its error of the sum over all triangles", S, float, double) {
  tests::check_windings<S>(collide::host(2), 50);
  tests::check_windings<S>(tests::lockstep<64, false>(), 10);
}

TEST_CASE_TEMPLATE("winding numbers: of a tree, whole around closed meshes", S, float, double) {
  auto const ball = tests::triangles_of(tests::icosphere<S>(4, 1, {0, 0, 0}));
  tests::dice roll(5);
  std::vector<collide::vec3<S>> points;
  for (int i = 0; i < 500; ++i) {
    auto const p = roll.in_cube(i % 2 == 0 ? 0.5 : 2);
    points.push_back(tests::from_oracle<S>(p));
  }
  for (double const beta : {2.0, 3.0, 6.0}) {
    CAPTURE(beta);
    double worst = 0, largest = 0;
    auto const found = winding_of<collide::bvh>(ball, points, beta);
    for (std::size_t i = 0; i < points.size(); ++i) {
      S const far = points[i].norm();
      if (far > S(0.99) && far < 1) continue;
      double const off = std::abs(double(found[i].value) - (far < 1 ? 1 : 0));
      CHECK(off <= double(found[i].error));
      worst = std::max(worst, off);
      largest = std::max(largest, double(found[i].error));
    }
    CHECK(largest < (beta < 3 ? 0.25 : beta < 6 ? 0.05 : 0.005));
    CHECK(worst < largest / 20);
    CHECK(worst > 0);
  }
}

TEST_CASE_TEMPLATE("winding numbers: a point within rounding of a triangle is on neither side", S, float, double) {
  tests::dice roll(6);
  auto const mesh = tests::triangles_of(tests::icosphere<S>(1, 1, {0.25, 0.5, 0.125}));
  std::vector<oracle::triangle> exact;
  for (auto const& t : mesh) exact.push_back(tests::to_oracle(t));
  std::vector<collide::vec3<S>> points;
  for (int i = 0; i < 2000; ++i) points.push_back(tests::point_at_surface(mesh, roll, 1));
  auto const found = winding_of(mesh, points), by_tree = winding_of<collide::bvh>(mesh, points);
  int wrong = 0, unsure = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double const whole = oracle::inside(exact, tests::to_oracle(points[i])) ? 1 : 0;
    for (auto const& w : {found[i], by_tree[i]}) {
      wrong += !(std::abs(double(w.value) - whole) <= double(w.error));
      unsure += w.error > S(0.49);
    }
  }
  CHECK(wrong == 0);
  CHECK(unsure > 0);
}

TEST_CASE("winding numbers: a tree follows its mesh") {
  float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  unsigned const faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  float const at[] = {0.1f, 0.2f, 0.3f, 10.1f, 0.2f, 0.3f};
  auto const points = collide::points(at, 2);
  collide::detector<collide::bvh> detector;
  collide::winding_number<> sink;
  auto const inside = [&](std::size_t i) { return detector.query(points, sink).to_host()[i].value > 0.5f; };
  detector.build(collide::indexed_mesh(corners, 4, faces, 4));
  CHECK(inside(0));
  CHECK_FALSE(inside(1));
  for (int k = 0; k < 12; k += 3) corners[k] += 10;
  detector.refit(collide::indexed_mesh(corners, 4, faces, 4));
  CHECK_FALSE(inside(0));
  CHECK(inside(1));
  for (int k = 0; k < 12; k += 3) corners[k] -= 10;
  detector.build(collide::indexed_mesh(corners, 4, faces, 4));
  CHECK(inside(0));
  detector.build(collide::mesh_view<float>());
  CHECK(detector.query(points, sink).to_host()[0].value == 0);
  CHECK(detector.query(collide::points(at, 0), sink).size() == 0);
  CHECK_THROWS_AS(collide::winding_number<float>(1.9), collide::error);
  CHECK_THROWS_AS(collide::winding_number<double>(std::nan("")), collide::error);
}
