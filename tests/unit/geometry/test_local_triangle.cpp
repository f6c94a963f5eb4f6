/// Triangles relative to a sphere's centre, at rest and along a path, against long double.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include <collide/exact/detail/geometry/local_sweep.hpp>

using namespace collide::detail;

namespace {

using wide = Eigen::Matrix<long double, 3, 1>;

template <class S>
wide widened(collide::vec3<S> const& v) {
  return v.template cast<long double>();
}

template <class S>
struct random_scene {
  std::mt19937 engine{1};
  std::uniform_real_distribution<double> uniform{-1, 1};

  S number(double size) { return static_cast<S>(size * uniform(engine)); }
  collide::vec3<S> vector(double size) { return {number(size), number(size), number(size)}; }
};

/// Scales, within which nothing over- or underflows.
template <class S>
constexpr int exponents = std::is_same<S, float>::value ? 60 : 450;

}  // namespace

TEST_CASE_TEMPLATE("local triangle: differences, scaled by a power of two to numbers from 1 to 4", S, float, double) {
  random_scene<S> random;
  bool is_near = true, is_scaled = true;
  for (int i = 0; i < 20000; ++i) {
    double const size = std::exp2(exponents<S> * random.uniform(random.engine));
    auto const origin = random.vector(i % 3 == 0 ? 1000 * size : size);
    collide::triangle<S> const t{origin + random.vector(size), origin + random.vector(size),
                                 origin + random.vector(size)};
    collide::moving_sphere<S> const s{{origin + random.vector(size), std::abs(random.number(size))},
                                      random.vector(size)};

    auto const l = to_local<double>(t, s);
    double const largest = std::max({max_norm(l.shape.a), max_norm(l.shape.b), max_norm(l.shape.c), l.shape.radius});
    CHECK(max_norm(l.shape) == largest);
    CHECK(max_norm(l) == std::max(largest, max_norm(l.path)));
    auto const near = [&](collide::vec3<double> const& found, collide::vec3<S> const& vertex) {
      return (widened(found) - (widened(vertex) - widened(s.centre))).norm() <=
             std::numeric_limits<double>::epsilon() * largest;
    };
    is_near = is_near && near(l.shape.a, t.a) && near(l.shape.b, t.b) && near(l.shape.c, t.c);

    auto const unit = to_unit_range(l, t, s);
    double const scale = unit.shape.scale;
    is_scaled = is_scaled && max_norm(unit) >= 1 && max_norm(unit) < 4 && std::exp2(std::ilogb(scale)) == scale &&
                unit.shape.a == l.shape.a * scale && unit.path == l.path * scale &&
                unit.shape.radius == l.shape.radius * scale;
    auto const still = to_unit_range(l.shape, t, static_cast<collide::sphere<S> const&>(s));
    is_scaled = is_scaled && max_norm(still) >= 1 && max_norm(still) < 4;
  }
  CHECK(is_near);
  CHECK(is_scaled);
}

TEST_CASE_TEMPLATE("local triangle: differences beyond the range are scaled first", S, float, double) {
  constexpr S huge = std::numeric_limits<S>::max();
  collide::triangle<S> const t{{huge, 0, 0}, {huge, 1, 0}, {huge, 0, 1}};
  collide::sphere<S> const s{{-huge, 0, 0}, 1};
  auto const unit = to_unit_range(to_local<S>(t, s), t, s);
  CHECK(max_norm(unit) >= 1);
  CHECK(max_norm(unit) < 4);
  CHECK(unit.a.x() == max_norm(unit));
}

TEST_CASE_TEMPLATE("local triangle: a box out of reach on one axis, also of a whole path", S, float, double) {
  random_scene<S> random;
  bool is_right = true;
  int within = 0;
  for (int i = 0; i < 20000; ++i) {
    local_sweep<S> const l{{random.vector(1) + random.vector(1), random.vector(1), random.vector(1), 1, 1},
                           random.vector(2)};
    S const reach = std::abs(random.number(1));
    auto const expected = [&](S time_from, S time_to) {
      bool near = true;
      for (int k = 0; k < 3; ++k) {
        S const to = time_to * l.path[k], from = time_from * l.path[k];
        S const least = std::min({l.shape.a[k], l.shape.b[k], l.shape.c[k]}) - std::max(from, to),
                most = std::max({l.shape.a[k], l.shape.b[k], l.shape.c[k]}) - std::min(from, to);
        near = near && least <= reach && -most <= reach;
      }
      return near;
    };
    is_right = is_right && aabb_within(l.shape, reach) == expected(0, 0) && aabb_within(l, reach) == expected(0, 1);
    is_right = is_right && aabb_within(at_time(l, S(1)), reach) == expected(1, 1);
    within += aabb_within(l, reach);
  }
  CHECK(is_right);
  CHECK(within > 1000);
}
