/// The order in which many points search a tree on the host: each once, with the answers that they have without.
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/bvh.cuh>
#include <collide/sinks/contains.hpp>
#include <collide/sinks/nearest.hpp>

#include "nearest/point_cases.hpp"

using namespace collide::detail;

namespace {

constexpr float far = std::numeric_limits<float>::infinity();
constexpr aabb<float> around{{-1, -1, -1}, {1, 1, 1}}, below{{-1, -1, -far}, {1, 1, 1}};

std::vector<float> points_in_cube(std::size_t n, double half) {
  tests::dice roll(5);
  std::vector<float> xyz;
  for (std::size_t i = 0; i < n; ++i) {
    auto const p = roll.in_cube(half);
    for (double const x : {p.x, p.y, p.z}) xyz.push_back(static_cast<float>(x));
  }
  return xyz;
}

collide::id const* sorted(points_on_curve<float>& order, int threads, std::vector<float> const& xyz, double fewest) {
  collide::host space(threads);
  return order.sort(space, collide::spheres_xyz(xyz.data(), xyz.size() / 3, 0.0f), around, below, fewest, {0, 0, 0});
}

}  // namespace

TEST_CASE("tree: an order has each point once, those that end at the box last") {
  for (std::size_t const n : {5000u, 100000u}) {
    auto xyz = points_in_cube(n, 3);
    xyz[30] = far, xyz[61] = std::numeric_limits<float>::quiet_NaN();
    auto const is_searched = [&](std::size_t i) {
      float const *const p = xyz.data() + 3 * i, x = p[0], y = p[1], z = p[2];
      return !(x < -1 || x > 1 || y < -1 || y > 1 || z > 1);
    };
    std::size_t searched = 0;
    for (std::size_t i = 0; i < n; ++i) searched += is_searched(i);
    std::vector<collide::id> first;
    for (int const threads : {1, 2, 3}) {
      points_on_curve<float> order;
      collide::id const* const ids = sorted(order, threads, xyz, 0.01);
      REQUIRE(ids != nullptr);
      std::vector<char> seen(n);
      std::size_t wrong = 0;
      for (std::size_t k = 0; k < n; ++k) {
        wrong += is_searched(ids[k]) != (k < searched) || seen[ids[k]];
        seen[ids[k]] = 1;
      }
      CHECK(wrong == 0);
      if (threads == 1) first.assign(ids, ids + n);
      CHECK(std::equal(first.begin(), first.end(), ids));
    }
  }
}

TEST_CASE("tree: points that have an order, or mostly end at the box, are left as they are") {
  points_on_curve<float> order;
  CHECK(sorted(order, 1, points_in_cube(5000, 3), 0.2) == nullptr);
  CHECK(sorted(order, 1, points_in_cube(5000, 1), 0.2) != nullptr);
  std::vector<float> line, above = points_in_cube(5000, 1);
  for (int i = 0; i < 5000; ++i) line.insert(line.end(), {static_cast<float>(i) / 5000, 0, 0});
  for (std::size_t i = 2; i < above.size(); i += 3) above[i] += 3;
  CHECK(sorted(order, 1, line, 0.2) == nullptr);
  CHECK(sorted(order, 1, above, 0) == nullptr);
}

TEST_CASE_TEMPLATE("tree: many points, near, above, below and far, have the answers of all pairs", S, float, double) {
  tests::dice roll(12);
  auto const mesh = tests::triangles_of(tests::icosphere<S>(5, 1, {3, 4, 5}));
  std::vector<S> corners, points;
  for (auto const& t : mesh) {
    for (auto const* p : {&t.a, &t.b, &t.c}) corners.insert(corners.end(), p->data(), p->data() + 3);
  }
  for (int i = 0; i < 4500; ++i) {
    auto const p = roll.in_cube(i % 3 == 2 ? 20 : 1.1);
    double const up = i % 4 == 0 ? 3 : i % 4 == 1 ? -3 : 0;
    for (double const x : {3 + p.x, 4 + p.y, 5 + p.z + up}) points.push_back(static_cast<S>(x));
  }
  auto const ask = [&](auto broad, std::size_t n, int threads, S max_distance) {
    collide::detector<decltype(broad), collide::karabassi<>, collide::host, S> detector{collide::host(threads)};
    detector.build(collide::triangle_soup(corners.data(), mesh.size()));
    collide::contains inside;
    collide::nearest<S> nearest(max_distance);
    detector.query(collide::spheres_xyz(points.data(), n, S(0)), inside);
    detector.query(collide::spheres_xyz(points.data(), n, S(0)), nearest);
    std::vector<std::pair<bool, collide::id>> found;
    for (std::size_t i = 0; i < 500; ++i) found.emplace_back(inside.to_host()[i], nearest.to_host()[i].triangle);
    return found;
  };
  for (S const max_distance : {S(0.5), std::numeric_limits<S>::infinity()}) {
    auto const expected = ask(collide::all_pairs(), 500, 2, max_distance);
    CHECK(ask(collide::bvh(), 4500, 1, max_distance) == expected);
    CHECK(ask(collide::bvh(), 4500, 3, max_distance) == expected);
  }
}
