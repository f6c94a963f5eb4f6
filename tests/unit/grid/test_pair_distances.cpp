/// Sampled distances of a scene.
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include <collide/broad/detail/grid/pair_distances.hpp>

using collide::detail::pair_distances;
using collide::detail::share_of_pairs;

TEST_CASE("pair distances: every distance is in the octave that its bin says") {
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> exponent(-27, 3);
  for (int i = 0; i < 10000; ++i) {
    float const distance = std::exp2(exponent(engine));
    auto const bin = pair_distances::bin_of(distance);
    CHECK(distance < pair_distances::end_of(bin));
    CHECK((bin == 0 || distance >= pair_distances::end_of(bin - 1)));
  }
  CHECK(pair_distances::bin_of(0) == 0);
  CHECK(pair_distances::bin_of(8) == pair_distances::bins - 1);
  CHECK(pair_distances::bin_of(1e30f) == pair_distances::bins - 1);
}

TEST_CASE("pair distances: of points in a volume the share grows with the cube of the distance") {
  // pairs of uniform points of a unit cube, on the axis where they are farther apart: a share of (2 d)^3, but at the
  // edges
  std::mt19937 engine(2);
  std::uniform_real_distribution<float> uniform(0, 1);
  pair_distances seen{};
  seen.sampled = pair_distances::spheres;
  for (std::uint32_t i = 0; i < seen.sampled * pair_distances::triangles; ++i) {
    float most = 0;
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(uniform(engine) - uniform(engine)));
    ++seen.counts[pair_distances::bin_of(most)];
  }
  share_of_pairs const share(seen);
  float before = 0;
  for (float d = 1.f / 1024; d < 0.2f; d *= 2) {
    float const expected = 8 * d * d * d;
    if (d > 1.f / 64) {  // below, hardly any pair was sampled
      CHECK(share(d, 0) > expected / 3);
      CHECK(share(d, 0) < expected * 3);
    }
    CHECK(share(d, 0) >= before);
    before = share(d, 0);
  }
  CHECK(share(0, 0) == 0);
  CHECK(share(1e30f, 0) == 1);
  CHECK(share(0.01f, 0.1f) > share(0.01f, 0));  // larger triangles are nearer
}

TEST_CASE("pair distances: nothing sampled is no share") {
  share_of_pairs const share(pair_distances{});
  for (float d : {0.f, 0.1f, 1.f}) CHECK(share(d, 0.1f) == 0);
  CHECK(pair_distances{}.mean_path() == 0);
}

TEST_CASE_TEMPLATE("pair distances: paths of spheres", S, float, double) {
  collide::moving_sphere<S> const s{{{1, 2, 3}, 1}, {2, -8, 4}};
  CHECK(collide::detail::path_of(s) == 8);
  CHECK(collide::detail::path_of(static_cast<collide::sphere<S> const&>(s)) == 0);
  CHECK(collide::detail::sphere_on_path(s, S(0.5)).centre == collide::vec3<S>(2, -2, 5));
  CHECK(collide::detail::sphere_on_path(static_cast<collide::sphere<S> const&>(s), S(0.5)).centre ==
        collide::vec3<S>(1, 2, 3));
}
