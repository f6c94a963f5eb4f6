/// Triangles that are compared with spheres eight at a time, and what a sample of the candidates tells of the hits.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>
#include <io/scenes.hpp>

#include <collide/all_pairs.cuh>
#include <collide/automatic.cuh>
#include <collide/bucket.cuh>

namespace {

using collide::detail::triangle_aabb;
using collide::detail::triangle_group;

/// Eight triangles of a size around a point.
template <class S>
std::vector<collide::triangle<S>> some_triangles(std::mt19937& random, S around, S size) {
  std::uniform_real_distribution<S> at(around - size, around + size);
  auto const point = [&] { return collide::vec3<S>{at(random), at(random), at(random)}; };
  std::vector<collide::triangle<S>> made;
  for (int i = 0; i < 8; ++i) made.push_back({point(), point(), point()});
  return made;
}

/// The group of the first eight triangles.
template <class S>
triangle_group<S> group_of(std::vector<collide::triangle<S>> const& triangles) {
  std::vector<S> numbers;
  for (auto const& t : triangles) {
    for (auto const& p : {t.a, t.b, t.c}) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
  }
  triangle_group<S> group{};
  group.load(collide::triangle_soup(numbers.data(), triangles.size()), 0);
  return group;
}

template <class S>
void check_group() {
  std::mt19937 random(1);
  int inside = 0;
  for (int round = 0; round < 2000; ++round) {
    S const size = round % 2 == 0 ? S(1) : S(1e-3);
    auto const triangles = some_triangles<S>(random, S(round % 7), size);
    std::vector<triangle_aabb<S>> boxes;
    for (auto const& t : triangles) boxes.push_back(collide::detail::triangle_aabb_of(t));
    auto const group = group_of<S>(triangles);
    REQUIRE(group.there == 0xff);
    std::uniform_real_distribution<S> at(S(round % 7) - 3 * size, S(round % 7) + 3 * size), far(0, 4 * size);
    collide::sphere<S> const ball{{at(random), at(random), at(random)}, far(random)};
    std::uint32_t expected = 0;
    for (std::uint32_t i = 0; i < 8; ++i) {
      if (boxes[i].overlaps(ball.centre, ball.radius)) expected |= 1u << i;
    }
    S const reach = triangle_aabb<S>::padded_radius(ball.radius);
    CHECK(group.reached_by(ball.centre.x(), ball.centre.y(), ball.centre.z(), reach) == expected);
    if (expected != 0) CHECK(group.all.overlaps(ball.centre, ball.radius));
    if (!group.is_inside(ball)) continue;
    ++inside;
    for (auto const& t : triangles) CHECK(collide::karabassi<>::intersects(t, ball));
  }
  CHECK(inside > 50);
}

/// A copy of a scene's numbers.
struct numbers {
  std::vector<float> vertices, centres, radii;
  std::vector<collide::id> corners;
  float radius;

  explicit numbers(io::scene const& s)
      : vertices(s.vertices.begin(), s.vertices.end()),
        centres(s.centres.begin(), s.centres.end()),
        radii(s.radii.begin(), s.radii.end()),
        corners(s.corners),
        radius{static_cast<float>(s.radius)} {}

  collide::mesh_view<float> mesh() const {
    return collide::indexed_mesh(vertices.data(), vertices.size() / 3, corners.data(), corners.size() / 3);
  }
  collide::sphere_view<float> spheres() const {
    std::size_t const n = centres.size() / 3;
    return radii.empty() ? collide::spheres_xyz(centres.data(), n, radius)
                         : collide::spheres_xyz(centres.data(), n, radii.data());
  }
};

}  // namespace

TEST_CASE("a group of triangles: which boxes a sphere reaches is what each box says, and inside is inside") {
  check_group<float>();
  check_group<double>();
}

TEST_CASE("a group is certain of nothing where squares overflow, and is none with a triangle that is not finite") {
  float const huge = 3e19f, tiny = 1e-25f;
  for (float const scale : {huge, tiny}) {
    std::vector<collide::triangle<float>> triangles(8, {{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}});
    auto const group = group_of<float>(triangles);
    REQUIRE(group.there == 0xff);
    CHECK(!group.is_inside({{0, 0, 0}, scale}));
    CHECK(!group.is_inside({{0, 0, 0}, 0}));
    triangles[5] = {{0, 0, 0}, {std::numeric_limits<float>::quiet_NaN(), 0, 0}, {0, 1, 0}};
    CHECK(group_of<float>(triangles).there == 0xdf);
  }
}

TEST_CASE("a group of triangles has the boxes that the triangles have, in any layout, also at the end of a mesh") {
  constexpr std::size_t n = 13;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> at(-5, 5);
  std::vector<float> packed, apart;
  std::vector<collide::id> corners;
  for (std::size_t i = 0; i < 3 * n; ++i) {
    for (int k = 0; k < 3; ++k) packed.push_back(at(random));
    corners.push_back(static_cast<collide::id>(3 * n - 1 - i));
  }
  packed[3 * 20 + 1] = std::numeric_limits<float>::infinity();  // of triangle 6
  for (std::size_t i = 0; i < 3 * n; ++i)
    apart.insert(apart.end(), {packed[3 * i], packed[3 * i + 1], packed[3 * i + 2], 7});
  for (auto const& mesh :
       {collide::indexed_mesh(packed.data(), 3 * n, corners.data(), n), collide::triangle_soup(packed.data(), n),
        collide::triangle_soup(collide::points(apart.data(), 3 * n, 4))}) {
    for (std::size_t first : {0u, 8u}) {
      triangle_group<float> group;
      group.load(mesh, first);
      triangle_aabb<float> all{collide::detail::aabb<float>::empty(), 0};
      for (std::uint32_t i = 0; i < 8; ++i) {
        bool const there = first + i < n && first + i != 6;
        CHECK((group.there >> i & 1) == (there ? 1 : 0));
        CHECK(group.box(i).is_empty() == !there);
        if (!there) continue;
        auto const box = collide::detail::triangle_aabb_of(mesh[first + i]), found = group.box(i);
        for (int k = 0; k < 3; ++k) {
          CHECK(found.lower[k] == box.lower[k]);
          CHECK(found.upper[k] == box.upper[k]);
          all.lower[k] = std::min(all.lower[k], box.lower[k]);
          all.upper[k] = std::max(all.upper[k], box.upper[k]);
        }
        CHECK(found.padding == box.padding);
        CHECK(group[i].b == mesh[first + i].b);
        all.padding = std::max(all.padding, box.padding);
      }
      for (int k = 0; k < 3; ++k) {
        CHECK(group.all.lower[k] == all.lower[k]);
        CHECK(group.all.upper[k] == all.upper[k]);
      }
      CHECK(group.all.padding == all.padding);
    }
  }
}

TEST_CASE("many hits and radii that differ: pairs are those of all_pairs, with any number of threads") {
  for (char const* name : {"hits", "many_hits", "radii_1000", "radii_100", "crowd", "camera", "soup", "drum"}) {
    CAPTURE(name);
    auto const& kind = *io::find_scene(name);
    numbers const made(kind.make(4000, 1003, 0));  // the last group is not whole
    collide::detector<collide::all_pairs> plain;
    auto const expected =
        plain.detect(made.mesh(), made.spheres(), collide::pairs(collide::order::canonical)).to_host();
    for (int threads : {1, 3}) {
      collide::detector<collide::bucket> detector{collide::host(threads)};
      auto const found =
          detector.detect(made.mesh(), made.spheres(), collide::pairs(collide::order::canonical)).to_host();
      CHECK((found == expected));
    }
  }
}

TEST_CASE("a first query of many hits runs once: a sample of the candidates tells how many there are") {
  for (char const* name : {"hits", "many_hits", "crowd"}) {
    CAPTURE(name);
    auto const& kind = *io::find_scene(name);
    numbers const made(kind.make(20000, 20000, 0));
    collide::detector<collide::bucket> detector{collide::host(2)};
    detector.build(made.mesh());
    struct sink {
      std::uint64_t expected = 0, total = 0;
      collide::count counted;
      void run(collide::host& space, collide::detail::query_pass<collide::bucket::index<float>, collide::karabassi<>,
                                                                 collide::host, float> const& query) {
        expected = query.expected_hits();
        counted.run(space, query);
        total = counted.total();
      }
    };
    sink told;
    detector.query(made.spheres(), told);
    CHECK(told.total > made.spheres().size());
    CHECK(told.expected >= told.total);
    CHECK(told.expected <= told.total + told.total / 4 + 20000);
  }
}
