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

TEST_CASE_TEMPLATE("signed queries: many points, which the host sorts, have the answers of few", S, float, double) {
  for (double const offset : {0.0, 1e5}) {
    tests::dice roll(11);
    auto const mesh = tests::triangles_of(tests::icosphere<S>(4, 1, {offset, offset, offset}));
    std::vector<collide::vec3<S>> points;
    for (int i = 0; i < 5000; ++i) {
      auto const p = roll.in_cube(i % 3 == 0 ? 1.5 : 50);
      points.push_back(i % 3 == 1 ? tests::point_at_surface(mesh, roll, 1)
                                  : tests::from_oracle<S>({offset + p.x, offset + p.y, offset + p.z}));
      if (i % 100 == 99) points.back()[i % 3] = std::numeric_limits<S>::infinity();
    }
    auto const many = tests::ask<collide::bvh>(collide::host(2), mesh, points);
    int wrong = 0;
    for (std::size_t begin = 0; begin < points.size(); begin += 1000) {
      std::vector<collide::vec3<S>> const few(points.begin() + begin, points.begin() + begin + 1000);
      auto const here = tests::ask<collide::bvh>(collide::host(1), mesh, few);
      for (std::size_t i = 0; i < few.size(); ++i) {
        auto const &a = here.distances[i], &b = many.distances[begin + i];
        wrong += here.inside[i] != many.inside[begin + i] || a.triangle != b.triangle ||
                 (a.triangle != collide::no_id && !tests::same_bits<S>(a, b));
      }
    }
    CHECK(wrong == 0);
  }
}
