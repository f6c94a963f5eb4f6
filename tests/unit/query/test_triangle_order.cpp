/// Groups of triangles that are close to each other, of meshes in any order, and the pairs that are found with them.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include <doctest/doctest.h>
#include <io/scenes.hpp>
#include <io/scenes/order.hpp>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/karabassi_swept.hpp>

using namespace collide::detail;

namespace {

constexpr io::order orders[] = {io::order::made, io::order::shuffled, io::order::along_x, io::order::halves};

/// A scene with all of its numbers in S.
template <class S>
struct numbers {
  std::vector<S> vertices, centres, radii, displacements;
  std::vector<collide::id> corners;

  explicit numbers(io::scene const& s)
      : vertices(s.vertices.begin(), s.vertices.end()),
        centres(s.centres.begin(), s.centres.end()),
        radii(s.radii.begin(), s.radii.end()),
        displacements(s.centres.size(), static_cast<S>(s.radius)),
        corners(s.corners) {
    radii.resize(centres.size() / 3, static_cast<S>(s.radius));
  }

  collide::mesh_view<S> mesh() const {
    return collide::indexed_mesh(vertices.data(), vertices.size() / 3, corners.data(), corners.size() / 3);
  }
  collide::sphere_view<S> spheres() const { return collide::spheres_xyz(centres.data(), radii.size(), radii.data()); }
};

/// Each triangle is in one group, as it is in the mesh, and nothing else is. Returns the sum of the groups' extents.
template <class S>
double check_groups(collide::mesh_view<S> const& mesh, grouped_mesh<S> const& groups) {
  std::vector<int> seen(mesh.size());
  double extents = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    triangle_group<S> group;
    groups.load(group, g);
    int there = 0;
    for (std::uint32_t k = 0; k < 8; ++k) {
      if (!group.has(k)) continue;
      ++there;
      auto const number = groups.number_of(static_cast<collide::id>(8 * g + k));
      REQUIRE(number < mesh.size());
      ++seen[number];
      auto const expected = mesh[number], found = group[k];
      CHECK((found.a == expected.a && found.b == expected.b && found.c == expected.c));
    }
    if (there != 0) extents += static_cast<double>(group.all.max_extent());
  }
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) wrong += seen[i] != (aabb_of(mesh[i]).is_empty() ? 0 : 1);
  CHECK(wrong == 0);
  return extents;
}

template <class S>
void check_orders(io::scene const& made) {
  for (io::order const wanted : orders) {
    CAPTURE(static_cast<int>(wanted));
    io::scene s = made;
    io::order_triangles(s, wanted, 1);
    numbers<S> const scene(s);
    auto const mesh = scene.mesh();
    collide::detector<collide::all_pairs, collide::karabassi<>, collide::host, S> plain(collide::host(2));
    auto const expected = plain.detect(mesh, scene.spheres(), collide::pairs(collide::order::canonical)).to_host();
    REQUIRE(expected.size() > 10);
    for (int threads : {1, 3}) {
      collide::detector<collide::bucket, collide::karabassi<>, collide::host, S> detector{collide::host(threads)};
      detector.build(mesh);
      for (int again = 0; again < 2; ++again) {
        CHECK((detector.query(scene.spheres(), collide::pairs(collide::order::canonical)).to_host() == expected));
        CHECK(detector.query(scene.spheres(), collide::count()).total() == expected.size());
      }
    }
  }
}

}  // namespace

TEST_CASE_TEMPLATE("triangles in any order: each is in one group, and groups are small", S, float, double) {
  io::scene s = io::study_scene(0, 5000, 1);
  double best = 0;
  for (io::order const wanted : orders) {
    CAPTURE(static_cast<int>(wanted));
    io::scene ordered = s;
    io::order_triangles(ordered, wanted, 2);
    numbers<S> const scene(ordered);
    double alone = 0;
    for (int threads : {1, 3}) {
      group_triangles<S> find;
      collide::host const space(threads);
      auto const groups = find(space, scene.mesh());
      CHECK((groups.numbers == nullptr) == (wanted == io::order::made || wanted == io::order::halves));
      double const extents = check_groups(scene.mesh(), groups);
      if (threads == 1) alone = extents;
      CHECK(extents == alone);  // the same groups, whatever the number of threads
    }
    if (wanted == io::order::made) best = alone;
    CHECK(alone < 2 * best);
  }
}

TEST_CASE_TEMPLATE("triangles in any order: few, soups, at one point, and such that are not finite", S, float, double) {
  for (std::size_t n : {1u, 7u, 8u, 9u, 100u, 1003u}) {
    CAPTURE(n);
    io::scene s = io::soup_scene(0, n, 3);
    numbers<S> scene(s);
    auto const check = [&] {
      group_triangles<S> find;
      collide::host const space(2);
      check_groups(scene.mesh(), find(space, scene.mesh()));
      std::vector<S> soup;
      for (auto const c : scene.corners) soup.insert(soup.end(), &scene.vertices[3 * c], &scene.vertices[3 * c] + 3);
      auto const as_soup = collide::triangle_soup(soup.data(), soup.size() / 9);
      check_groups(as_soup, find(space, as_soup));
    };
    check();
    for (std::size_t i = 0; i < scene.vertices.size(); i += 50) {
      scene.vertices[i] = i % 3 == 0 ? std::numeric_limits<S>::infinity() : std::numeric_limits<S>::quiet_NaN();
    }
    check();
    std::fill(scene.vertices.begin(), scene.vertices.end(), S(1));
    check();
    std::fill(scene.vertices.begin(), scene.vertices.end(), std::numeric_limits<S>::quiet_NaN());
    check();
    for (std::size_t i = 0; i < scene.vertices.size(); ++i) {
      scene.vertices[i] = (i % 2 == 0 ? 1 : -1) * std::numeric_limits<S>::max() / static_cast<S>(i % 5 + 1);
    }
    check();
  }
}

TEST_CASE("triangles in any order: sorting by digits is sorting, also in parts") {
  for (std::size_t n : {0u, 1u, 1000u, 16384u, 70000u}) {
    std::vector<triangle_on_curve> made(n), spare(n), sorted(n);
    for (std::size_t i = 0; i < n; ++i) {
      made[i] = {static_cast<std::uint32_t>(i * 2654435761u >> 17 << 15 & 0x3fffffff), static_cast<collide::id>(i)};
    }
    auto expected = made;
    std::stable_sort(expected.begin(), expected.end(), [](auto const& a, auto const& b) { return a.place < b.place; });
    for (int threads : {1, 4}) {
      collide::host const space(threads);
      sort_by_digit(space, made.data(), sorted.data(), n, 0);
      sort_by_digit(space, sorted.data(), spare.data(), n, 10);
      sort_by_digit(space, spare.data(), sorted.data(), n, 20);
      CHECK(std::equal(sorted.begin(), sorted.end(), expected.begin(),
                       [](auto const& a, auto const& b) { return a.place == b.place && a.number == b.number; }));
    }
  }
}

TEST_CASE_TEMPLATE("triangles in any order: the pairs are those of all_pairs", S, float, double) {
  SUBCASE("one radius") { check_orders<S>(io::study_scene(6000, 3000, 1)); }
  SUBCASE("many hits") { check_orders<S>(io::hits_scene(85, 300, 3001, 2)); }
  SUBCASE("radii that differ") { check_orders<S>(io::radii_scene(6000, 3000, 2)); }
  SUBCASE("several levels") { check_orders<S>(io::giant_scene(6000, 3000, 3)); }
  SUBCASE("soup") { check_orders<S>(io::soup_scene(4000, 3000, 4)); }
  SUBCASE("slivers") { check_orders<S>(io::drum_scene(4000, 1003, 5)); }
}

TEST_CASE("triangles in any order: the pairs of spheres that move are those of all_pairs") {
  io::scene s = io::study_scene(9000, 2000, 1);
  io::order_triangles(s, io::order::shuffled, 1);
  numbers<float> const scene(s);
  auto const spheres = collide::with_displacements(collide::spheres_xyz(scene.centres.data(), scene.radii.size(), 3.f),
                                                   scene.displacements.data());
  collide::detector<collide::all_pairs, collide::karabassi_swept<>> plain;
  collide::detector<collide::bucket, collide::karabassi_swept<>> sorted(collide::host(2));
  auto const expected = plain.detect(scene.mesh(), spheres, collide::pairs(collide::order::canonical)).to_host();
  CHECK(expected.size() > 10);
  CHECK((sorted.detect(scene.mesh(), spheres, collide::pairs(collide::order::canonical)).to_host() == expected));
}

TEST_CASE("a grid that was made for few spheres is made anew for many, and a radius is only a hint") {
  numbers<float> const scene(io::study_scene(60000, 5000, 1));
  auto const spheres = [&](std::size_t n) { return collide::spheres_xyz(scene.centres.data(), n, 3.f); };
  collide::detector<collide::bucket> few_first(collide::host(1)), many_first(collide::host(1));
  few_first.build(scene.mesh(), 3.f);
  many_first.build(scene.mesh(), 30.f);
  few_first.query(spheres(1000), collide::count());
  double const wide = few_first.cell_width();
  auto const found = few_first.query(spheres(60000), collide::pairs(collide::order::canonical)).to_host();
  CHECK((many_first.query(spheres(60000), collide::pairs(collide::order::canonical)).to_host() == found));
  CHECK(many_first.cell_width() < wide);
  CHECK(few_first.cell_width() == many_first.cell_width());
}
