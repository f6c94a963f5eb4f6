/// Bounding spheres of triangles, and their lifted form, against distances in long double.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include <collide/exact/detail/geometry/lifted_bounds.hpp>

namespace {

using collide::vec3;
using namespace collide::detail;

template <class S>
long double distance(vec3<S> const& a, vec3<S> const& b) {
  return (a.template cast<long double>() - b.template cast<long double>()).norm();
}

/// Triangles of many shapes and sizes, far from the origin and near it.
template <class S>
class random_triangles {
 public:
  vec3<S> vector(double size) {
    return vec3<S>(S(size * uniform_(engine_)), S(size * uniform_(engine_)), S(size * uniform_(engine_)));
  }
  double scale(double least, double most) { return std::exp2(least + (most - least) * (uniform_(engine_) + 1) / 2); }
  collide::triangle<S> next() {
    double const size = scale(-20, 10);
    vec3<S> const at = vector(scale(-10, 10));
    return {at, at + vector(size), at + vector(size * scale(-15, 0))};
  }

 private:
  std::mt19937 engine_{1};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

}  // namespace

TEST_CASE_TEMPLATE("bounding sphere: contains the triangle, and is no larger than it must be", S, float, double) {
  random_triangles<S> random;
  for (int i = 0; i < 20000; ++i) {
    auto const t = random.next();
    auto const b = bounding_sphere_of(t);
    vec3<S> const centre(b.x, b.y, b.z);
    long double const farthest =
        std::max({distance<S>(centre, t.a), distance<S>(centre, t.b), distance<S>(centre, t.c)});
    CHECK(farthest <= static_cast<long double>(b.radius));
    auto const tiny = 2 * std::sqrt(static_cast<long double>(std::numeric_limits<S>::min()));
    CHECK(static_cast<long double>(b.radius) <= farthest * 1.00001L + tiny * 1.00001L);
  }
}

TEST_CASE_TEMPLATE("bounding sphere: what reaches it overlaps it, also in lifted form", S, float, double) {
  random_triangles<S> random;
  int reached = 0;
  for (int i = 0; i < 20000; ++i) {
    auto const t = random.next();
    auto const b = bounding_sphere_of(t);
    vec3<S> const centre(b.x, b.y, b.z);
    S const r = S(random.scale(-10, 5));
    double const reach = double(b.radius) + double(r);
    vec3<S> const c = centre + random.vector(reach);
    lifted_batch<S, 4> one;
    S const same[] = {c.x(), c.y(), c.z(), c.x(), c.y(), c.z(), c.x(), c.y(), c.z(), c.x(), c.y(), c.z()};
    one.load(collide::spheres_xyz(same, 4, r), 0, t.a);
    bool const overlaps = b.overlaps(c, r), lifted = one.any_overlaps(lifted_bounds<S>(b, t.a));
    long double const between = distance<S>(centre, c), sum = static_cast<long double>(b.radius) + r;
    if (between <= sum) {
      ++reached;
      CHECK(overlaps);
      CHECK(lifted);
    } else if (between > 1.001L * sum) {
      CHECK_FALSE(overlaps);
      CHECK_FALSE(lifted);
    }
  }
  CHECK(reached > 5000);
}

TEST_CASE_TEMPLATE("bounding sphere: nothing overlaps a triangle that is not finite, all a huge one", S, float,
                   double) {
  S const nan = std::numeric_limits<S>::quiet_NaN(), most = std::numeric_limits<S>::max();
  vec3<S> const zero(0, 0, 0);
  for (S const bad : {nan, std::numeric_limits<S>::infinity()}) {
    auto const b = bounding_sphere_of(collide::triangle<S>{zero, {bad, 0, 0}, {0, 1, 0}});
    CHECK(std::isnan(b.radius));
    CHECK_FALSE(b.overlaps(zero, S(1)));
    CHECK_FALSE(b.overlaps(zero, most));
  }
  auto const huge = bounding_sphere_of(collide::triangle<S>{{-most, 0, 0}, {most, 0, 0}, {0, most, 0}});
  CHECK(huge.overlaps(zero, S(0)));
  CHECK(huge.overlaps(vec3<S>(S(1e30), 0, 0), S(1)));
}
