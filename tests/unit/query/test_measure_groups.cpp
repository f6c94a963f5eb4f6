/// Measures of a mesh that the host takes before triangles look for spheres, and the groups of triangles it leaves out.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory_resource>
#include <random>
#include <vector>

#include <doctest/doctest.h>
#include <io/counting.hpp>
#include <io/scenes/order.hpp>
#include <io/scenes/torus.hpp>

#include <collide/bucket.cuh>

#include "execution/lockstep.hpp"
#include "random_triangles.hpp"

using namespace collide::detail;

namespace {

/// Triangles of all sizes, one after the other of about the same, some with a number that is not finite.
template <class S>
std::vector<S> triangles(std::size_t n) {
  auto all = tests::random_triangles<S>(
      n, {100, 100, 0}, [](std::size_t i, auto const&) { return std::exp2(static_cast<double>(i / 50 % 40) - 20); });
  for (std::size_t i = 3; i < n; i += 170) all[9 * i + i % 9] = std::numeric_limits<S>::quiet_NaN();
  return all;
}

}  // namespace

TEST_CASE_TEMPLATE("groups of triangles: the host finds the statistics of a mesh that a device finds", S, float,
                   double) {
  for (std::size_t n : {1u, 9u, 3000u}) {
    auto const all = triangles<S>(n);
    auto const mesh = collide::triangle_soup(all.data(), n);
    mesh_statistics<S> seen{}, expected{};
    tests::lockstep<8, false> const device;
    compute_mesh_statistics<S> const reference{mesh, &expected, nullptr};
    device.launch(grid_size<tests::lockstep<8, false>>(n, reference), reference);
    std::vector<triangle_aabb<S>> groups(triangle_group<S>::count(n));
    measure_groups<S> const kernel{{mesh, nullptr}, &seen, groups.data()};
    collide::host(2).launch(kernel.blocks(), kernel);
    for (int k = 0; k < 3; ++k) {
      CHECK(seen.lower_of(k) == expected.lower_of(k));
      CHECK(seen.upper_of(k) == expected.upper_of(k));
    }
    CHECK(std::equal(seen.extents.counts, seen.extents.counts + size_bins, expected.extents.counts));
    CHECK(seen.extents.first() == expected.extents.first());
    CHECK(seen.extents.last() == expected.extents.last());
    bool close = true;
    for (std::uint32_t b = 0; b < size_bins; ++b) {
      auto const apart = static_cast<double>(seen.extents.sums[b]) - static_cast<double>(expected.extents.sums[b]);
      close = close && std::abs(apart) <= 1 + seen.extents.counts[b] / 64;
    }
    CHECK(close);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      triangle_group<S> group;
      group.load(mesh, 8 * i);
      CHECK(groups[i].lower[0] == group.all.lower[0]);
      CHECK(groups[i].padding == group.all.padding);
    }
  }
}

TEST_CASE_TEMPLATE("groups of triangles: the histogram of radii that the host finds has those that are valid", S, float,
                   double) {
  std::vector<S> radii;
  for (int i = 0; i < 10000; ++i) radii.push_back(static_cast<S>(std::exp2(i % 23 - 11)));
  for (S bad : {S(-1), std::numeric_limits<S>::infinity(), std::numeric_limits<S>::quiet_NaN()}) radii.push_back(bad);
  radii.push_back(S(0)), radii.push_back(S(-0.));
  std::vector<S> const centres(3 * radii.size());
  size_histogram seen{};
  measure_radii<S> const kernel{collide::spheres_xyz(centres.data(), radii.size(), radii.data()), &seen};
  collide::host(2).launch(kernel.blocks(), kernel);
  std::vector<std::uint64_t> counts(size_bins, 0);
  for (S r : radii) {
    if (r >= 0 && std::isfinite(r)) ++counts[size_bin(r + S(0))];
  }
  CHECK(std::equal(counts.begin(), counts.end(), seen.counts));
}

TEST_CASE("groups of triangles: none is left out that has spheres in its cells, also where cells wrap") {
  std::mt19937 random(1);
  for (std::uint32_t const mask : {3u, 15u, (1u << 31) - 1}) {
    constexpr std::uint32_t side = 16;
    grid<float> g{};
    g.levels = 1;
    g.level[0] = {1, 1, 1e9f, {mask, mask, mask}, {side, side * side}, 0};
    std::vector<std::uint32_t> ends(side * side * side + 2, 0);
    spheres_in_cells<float> in{};
    in.grids = &g;
    in.grid_count = 1;
    in.ends = ends.data();
    in.everywhere = side * side * side;
    int left_out = 0;
    for (int round = 0; round < 3000; ++round) {
      std::fill(ends.begin(), ends.end(), 0u);
      std::size_t const full = random() % ends.size();  // the cell before has a sphere
      for (std::size_t c = full; c < ends.size(); ++c) ends[c] = 1;
      std::uniform_real_distribution<float> at(0, 12.9f), size(0, 3);
      aabb<float> box;
      for (int k = 0; k < 3; ++k) box.lower[k] = at(random), box.upper[k] = box.lower[k] + size(random);
      bool there = false;
      each_range_of_group(g, box,
                          [&](std::uint32_t cell, std::uint32_t n) { there = there || ends[cell] != ends[cell + n]; });
      bool const near = in.grids_near(box) != 0;
      CHECK((near || !there));
      left_out += !near;
    }
    CHECK(left_out > 100);
  }
}

TEST_CASE("groups of triangles: the host keeps no box of each triangle, unless few spheres come again") {
  std::size_t bytes_of_order = 0;
  for (io::order const wanted : {io::order::made, io::order::shuffled}) {
    auto scene = io::study_scene(0, 50000);
    io::order_triangles(scene, wanted, 1);
    std::size_t const n = scene.triangle_count();
    std::vector<float> const vertices(scene.vertices.begin(), scene.vertices.end()), centres(3 * 100, 1.0f);
    io::counting_resource memory(std::pmr::new_delete_resource());
    collide::detector<collide::bucket> detector(collide::host(1, &memory));
    detector.build(collide::indexed_mesh(vertices.data(), vertices.size() / 3, scene.corners.data(), n));
    CHECK(memory.in_use < bytes_of_order + 6 * n);
    auto const spheres = collide::spheres_xyz(centres.data(), centres.size() / 3, 1.0f);
    auto const first = detector.query(spheres, collide::pairs(collide::order::canonical)).to_host();
    CHECK(memory.in_use < bytes_of_order + 12 * n);
    for (int again = 0; again < 2; ++again) {
      CHECK((detector.query(spheres, collide::pairs(collide::order::canonical)).to_host() == first));
    }
    bytes_of_order = 36 * n;  // of the next one, for groups along a curve
  }
}

TEST_CASE("few spheres that come again: triangles are entered as soon as that pays") {
  auto const scene = io::study_scene(30000, 20000);
  std::size_t const n = scene.triangle_count();
  std::vector<float> const vertices(scene.vertices.begin(), scene.vertices.end()),
      centres(scene.centres.begin(), scene.centres.end());
  auto const mesh = collide::indexed_mesh(vertices.data(), vertices.size() / 3, scene.corners.data(), n);
  auto const query = [&](collide::detector<collide::bucket>& detector, std::size_t count) {
    return detector.query(collide::spheres_xyz(centres.data(), count, 3.0f), collide::pairs(collide::order::canonical))
        .to_host();
  };
  // the first query, counted from 1, that has entered them; 0 if none of 40 has
  auto const first_to_enter = [&](std::size_t count) {
    io::counting_resource memory(std::pmr::new_delete_resource());
    collide::detector<collide::bucket> detector(collide::host(1, &memory));
    detector.build(mesh);
    auto const pairs = query(detector, count);
    std::size_t const before = memory.in_use;
    for (std::size_t k = 2; k <= 40; ++k) {
      CHECK((query(detector, count) == pairs));
      if (memory.in_use > before + 4 * n) return k;
    }
    return std::size_t{0};
  };
  CHECK(first_to_enter(n / 4) == 0);
  CHECK(first_to_enter(n / 8) == 33);
  CHECK(first_to_enter(n / 32) == 9);
  CHECK(first_to_enter(n / 200) == 3);
  collide::detector<collide::bucket> both(collide::host(1));
  both.build(mesh);
  auto const all = query(both, n), few = query(both, n / 16);
  for (int k = 0; k < 20; ++k) {
    CHECK((query(both, n) == all));
    CHECK((query(both, n / 16) == few));
  }
  // with many triangles near each: they are entered, and then look for the spheres as before
  auto const large = collide::spheres_xyz(centres.data(), 100, 90.0f);
  auto const pairs = both.query(large, collide::pairs(collide::order::canonical)).to_host();
  CHECK(pairs.size() > 2000);
  for (int k = 0; k < 20; ++k) CHECK((both.query(large, collide::pairs(collide::order::canonical)).to_host() == pairs));
}
