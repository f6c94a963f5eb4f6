/// The closest approach of a path and a triangle, against a search over times and points.
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include <collide/exact/detail/predicates/filter_swept.hpp>

using namespace collide::detail;

namespace {

using wide = Eigen::Vector3d;

wide product(wide const& a, wide const& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

/// Distance of a point from a triangle: the least of its vertices, edges and face.
double distance_to(wide const& p, wide const (&v)[3]) {
  double least = 1e300;
  for (int i = 0; i < 3; ++i) {
    wide const from = v[i], along = v[(i + 1) % 3] - v[i];
    double const length = along.squaredNorm(), t = length > 0 ? std::clamp((p - from).dot(along) / length, 0., 1.) : 0;
    least = std::min(least, (from + t * along - p).norm());
  }
  wide const n = product(v[1] - v[0], v[2] - v[0]);
  if (n.squaredNorm() == 0) return least;
  for (int i = 0; i < 3; ++i) {
    if (product(v[(i + 1) % 3] - v[i], p - v[i]).dot(n) < 0) return least;
  }
  return std::min(least, std::abs((p - v[0]).dot(n)) / n.norm());
}

/// The least distance on the path from the origin: it is convex in time.
double least_distance(wide const& path, wide const (&v)[3]) {
  double low = 0, high = 1;
  for (int k = 0; k < 200; ++k) {
    double const a = low + (high - low) / 3, b = high - (high - low) / 3;
    (distance_to(a * path, v) < distance_to(b * path, v) ? high : low) =
        distance_to(a * path, v) < distance_to(b * path, v) ? b : a;
  }
  return distance_to(low * path, v);
}

}  // namespace

TEST_CASE_TEMPLATE("closest approach: as near as a search finds, and both points exist", T, float, double) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double const rounding = std::is_same<T, float>::value ? 2e-5 : 1e-12;
  int faces = 0;
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    auto const vector = [&](double size) {
      return collide::vec3<T>(T(size * uniform(engine)), T(size * uniform(engine)), T(size * uniform(engine)));
    };
    local_sweep<T> l{{vector(1), vector(1), vector(1), T(1), T(1)}, vector(i % 5 == 0 ? 0 : 2)};
    if (i % 7 == 0) l.path = scaled<T>(l.shape.b - l.shape.a, T(0.5));  // parallel to an edge, and to the face
    wide const v[3] = {l.shape.a.template cast<double>(), l.shape.b.template cast<double>(),
                       l.shape.c.template cast<double>()},
               path = l.path.template cast<double>();
    closest_approach<T> const found = approach(l);
    double const time = static_cast<double>(found.time), b = static_cast<double>(found.v),
                 c = static_cast<double>(found.w);
    CHECK(std::min({time, b, c}) >= 0);
    CHECK(time <= 1);
    CHECK(b + c <= 1 + rounding);
    wide const offset = v[0] + b * (v[1] - v[0]) + c * (v[2] - v[0]) - time * path;
    CHECK((offset - found.offset.template cast<double>()).norm() < rounding);
    // thin triangles amplify the rounding of the face's normal; then an edge is as near except for that
    worst = std::max(worst, std::abs(offset.norm() - least_distance(path, v)));
    faces += b > 0 && c > 0 && b + c < 1;
  }
  CHECK(worst < (std::is_same<T, float>::value ? 2e-3 : 1e-6));
  CHECK(faces > 1000);
}
