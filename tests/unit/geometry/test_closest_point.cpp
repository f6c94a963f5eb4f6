/// Closest points, against what makes a point the closest: no corner lies nearer to the origin's side of it.
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include <collide/exact/detail/geometry/closest_point.hpp>

namespace {

using vector = collide::vec3<double>;
using collide::feature;

/// Of the parallelogram of two vectors.
double area(vector const& a, vector const& b) {
  double const ab = a.dot(b);
  return std::sqrt(std::max(0.0, a.squaredNorm() * b.squaredNorm() - ab * ab));
}

}  // namespace

TEST_CASE("closest point: is on its feature, and no point of the triangle is nearer to the origin") {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto const random = [&] { return vector(uniform(engine), uniform(engine), uniform(engine)); };
  int found[3] = {};
  for (int i = 0; i < 30000; ++i) {
    double const flat = i % 3 == 0 ? 1e-3 : 1;
    vector const from = random(), a = from + random(), b = from + random() * flat, c = from + random();
    collide::detail::local_triangle<double> const t{a, b, c, 0, 1};
    vector const n = collide::detail::cross<double>(b - a, c - a);
    auto const best = collide::detail::closest_to_origin(t, n);
    vector const p = best.point;
    CHECK(best.distance_squared == doctest::Approx(p.squaredNorm()).epsilon(1e-12));
    // the plane through p perpendicular to it has all of the triangle on its other side
    for (vector const& corner : {a, b, c}) CHECK((corner - p).dot(p) >= -1e-12);
    vector const corners[] = {a, b, c};
    if (best.kind == feature::vertex) {
      CHECK(p == corners[best.index]);
    } else if (best.kind == feature::edge) {
      vector const& start = corners[best.index];
      vector const& end = corners[(best.index + 1) % 3];
      CHECK((p - start).norm() + (end - p).norm() == doctest::Approx((end - start).norm()).epsilon(1e-12));
    } else {
      double areas = 0;
      for (int k = 0; k < 3; ++k) areas += area(corners[k] - p, corners[(k + 1) % 3] - p);
      CHECK(areas == doctest::Approx(n.norm()).epsilon(1e-6));
    }
    ++found[best.kind == feature::vertex ? 0 : best.kind == feature::edge ? 1 : 2];
  }
  for (int const many : found) CHECK(many > 1000);
}

TEST_CASE("closest point: segments and points are triangles, too") {
  vector const from(1, -1, 0), to(1, 3, 0), at(2, 0, 0);
  collide::detail::local_triangle<double> const segment{from, to, to, 0, 1}, point{at, at, at, 0, 1};
  auto const of_segment = collide::detail::closest_to_origin(segment, vector(0, 0, 0));
  CHECK(of_segment.point == vector(1, 0, 0));
  CHECK(of_segment.kind == feature::edge);
  auto const of_point = collide::detail::closest_to_origin(point, vector(0, 0, 0));
  CHECK(of_point.point == vector(2, 0, 0));
  CHECK(of_point.kind == feature::vertex);
}
