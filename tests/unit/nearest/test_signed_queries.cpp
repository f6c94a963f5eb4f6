/// Inside and signed distance: queries of the host, and the kernels of devices in lockstep.
#include <collide/core/error.hpp>

#include "execution/lockstep.hpp"
#include "nearest/signed_queries.hpp"

TEST_CASE_TEMPLATE("signed queries: the same bits in every space and with every broad phase", S, float, double) {
  tests::check_signed_queries<collide::all_pairs, S>(collide::host(), 200);
  tests::check_signed_queries<collide::bvh, S>(collide::host(), 1000);
  tests::check_signed_queries<collide::bvh, S>(tests::lockstep<256, false>(), 1000);
}

TEST_CASE_TEMPLATE("signed queries: needles, which a tree cuts into pieces", S, float, double) {
  tests::check_signed_queries_of_needles<collide::bvh, S>(collide::host(), 1000);
  tests::check_signed_queries_of_needles<collide::bvh, S>(tests::lockstep<64, true>(), 300);
}

TEST_CASE_TEMPLATE("signed queries: situations of public threads", S, float, double) {
  tests::check_known_situations<collide::all_pairs, S>(collide::host());
  tests::check_known_situations<collide::bvh, S>(collide::host());
  tests::check_known_situations<collide::bvh, S>(tests::lockstep<64, true>());
}

TEST_CASE_TEMPLATE("signed queries: nothing there, not finite, and a largest distance", S, float, double) {
  tests::check_unusual_signed_queries<collide::all_pairs, S>(collide::host());
  tests::check_unusual_signed_queries<collide::bvh, S>(collide::host());
  CHECK_THROWS_AS(collide::signed_distance<S>(S(-1)), collide::error);
  CHECK_THROWS_AS(collide::signed_distance<S>(std::numeric_limits<S>::quiet_NaN()), collide::error);
}

TEST_CASE_TEMPLATE("signed queries: the side is exact in plain precisions too", S, float, double) {
  tests::dice roll(3);
  auto const mesh = tests::triangles_of(tests::icosphere<S>(1, 1, {100, 100, 100}));
  std::vector<collide::vec3<S>> points;
  for (int i = 0; i < 500; ++i) points.push_back(tests::point_at_surface(mesh, roll, 1));
  auto const exact = tests::ask<collide::bvh>(collide::host(), mesh, points);
  auto const plain = tests::ask<collide::bvh, collide::single_precision>(collide::host(), mesh, points);
  CHECK(plain.inside == exact.inside);
  for (std::size_t i = 0; i < points.size(); ++i)
    CHECK(std::signbit(plain.distances[i].distance) == std::signbit(exact.distances[i].distance));
}
