/// Spheres around and inside moving spheres, against long double.
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include <collide/exact/detail/geometry/bounding_sphere.hpp>

TEST_CASE_TEMPLATE("swept bounds: contain the sphere at all times, and lie in it at half time", S, float, double) {
  using collide::vec3;
  using wide = Eigen::Matrix<long double, 3, 1>;
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto const vector = [&](double size) {
    return vec3<S>(S(size * uniform(engine)), S(size * uniform(engine)), S(size * uniform(engine)));
  };
  auto const scale = [&] { return std::exp2(12 * uniform(engine)); };
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    double const size = scale();
    // every third sphere is much larger than its path
    double const path = i % 10 == 0 ? 0 : i % 3 == 0 ? size * std::exp2(20 * uniform(engine) - 40) : scale();
    collide::moving_sphere<S> const s{{vector(i % 3 == 0 ? size * 1e-9 : scale()), S(size)}, vector(path)};
    wide const from = s.centre.template cast<long double>(), by = s.displacement.template cast<long double>();
    auto const around = collide::detail::swept_bounding_sphere(s), within = collide::detail::midpoint_sphere(s);
    wide const centre = around.centre.template cast<long double>();
    bool contained = true;
    for (long double t : {0.0L, 0.25L, 0.5L, 0.75L, 1.0L}) {
      contained = contained && (from + by * t - centre).norm() + s.radius <= around.radius;
    }
    CHECK(contained);
    CHECK(static_cast<double>(around.radius) <=
          1.001 * (double(s.radius) + double(by.norm()) / 2 + double(from.norm() + by.norm()) * 1e-5));
    if (!(within.radius >= 0)) continue;
    ++inside;
    long double const off = (from + by / 2 - within.centre.template cast<long double>()).norm();
    CHECK(off + within.radius <= static_cast<long double>(s.radius));
  }
  CHECK(inside > 15000);
}
