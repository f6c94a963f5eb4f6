/// Winding numbers of closed meshes, of open ones and of soups, and their errors.
#include <cmath>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/bvh.cuh>
#include <collide/detail/numeric/angle.hpp>
#include <collide/sinks/winding_number.hpp>

#include "compared.hpp"
#include "nearest/point_cases.hpp"

namespace {

template <class BroadPhase = collide::all_pairs, class S>
std::vector<collide::winding<S>> winding_of(std::vector<collide::triangle<S>> const& mesh,
                                            std::vector<collide::vec3<S>> const& points) {
  std::vector<S> corners, coordinates;
  for (auto const& t : mesh)
    for (auto const& v : {t.a, t.b, t.c}) corners.insert(corners.end(), {v.x(), v.y(), v.z()});
  for (auto const& p : points) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});
  collide::detector<BroadPhase, collide::karabassi<>, collide::host, S> detector;
  detector.build(collide::triangle_soup(corners.data(), mesh.size()));
  return detector.query(collide::points(coordinates.data(), points.size()), collide::winding_number<S>()).to_host();
}

}  // namespace

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
  CHECK(winding_of<collide::bvh>(holed, middle)[0].value == winding_of(holed, middle)[0].value);
  CHECK(std::isnan(winding_of(cube, {{std::numeric_limits<S>::quiet_NaN(), 0, 0}})[0].value));
  S const large = std::numeric_limits<S>::max() / 4;
  for (auto& t : cube) t = {t.a * large, t.b * large, t.c * large};
  CHECK(winding_of(cube, {{large / 2, large / 2, large / 2}})[0].value == doctest::Approx(1));
}
