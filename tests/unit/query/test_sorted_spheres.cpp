/// Buckets on the host, where either the spheres or the triangles are in the cells, and where candidates are decided
/// several at a time.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>
#include <io/scenes.hpp>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/karabassi_swept.hpp>

#include "narrow_phase/narrow_phase.hpp"

namespace {

/// A scene with all of its numbers in S, a radius per sphere, and among the spheres some that are out of the ordinary.
template <class S>
struct numbers {
  std::vector<S> vertices, centres, radii;
  std::vector<collide::id> corners;

  explicit numbers(io::scene const& s)
      : vertices(s.vertices.begin(), s.vertices.end()),
        centres(s.centres.begin(), s.centres.end()),
        radii(s.radii.begin(), s.radii.end()),
        corners(s.corners) {
    radii.resize(centres.size() / 3, static_cast<S>(s.radius));
    constexpr S infinity = std::numeric_limits<S>::infinity(), nan = std::numeric_limits<S>::quiet_NaN();
    std::size_t i = 0;
    for (S const r : {infinity, nan, S(-1), S(0), S(1e4), -infinity}) radii[i++ * 7] = r;
    centres[3 * 50] = nan;
    centres[3 * 51 + 1] = infinity;
  }

  collide::mesh_view<S> mesh() const {
    return collide::indexed_mesh(vertices.data(), vertices.size() / 3, corners.data(), corners.size() / 3);
  }
  collide::sphere_view<S> spheres(std::size_t n) const { return collide::spheres_xyz(centres.data(), n, radii.data()); }
};

template <class S>
void check_sorted(io::scene const& scene) {
  using collide::order;
  using collide::pair;
  numbers<S> const made(scene);
  std::size_t const all = made.radii.size(), few = 3 * made.mesh().size();
  REQUIRE(all / 4 > made.mesh().size());
  collide::detector<collide::all_pairs, collide::karabassi<>, collide::host, S> plain(collide::host(2));
  auto const expected = plain.detect(made.mesh(), made.spheres(all), collide::pairs(order::canonical)).to_host();
  REQUIRE(expected.size() > 500);
  auto const of_few =
      std::find_if(expected.begin(), expected.end(), [&](pair p) { return p.sphere >= few; }) - expected.begin();
  for (int threads : {1, 2, 3, 7}) {
    CAPTURE(threads);
    collide::detector<collide::bucket, collide::karabassi<>, collide::host, S> detector{collide::host(threads)};
    for (bool with_few_first : {false, true}) {
      CAPTURE(with_few_first);
      detector.build(made.mesh());
      // the first query sorts the spheres, and so do all with many; others list the triangles
      for (bool many : {!with_few_first, true, false, false, true}) {
        CAPTURE(many);
        auto const spheres = made.spheres(many ? all : few);
        auto const size = many ? expected.size() : static_cast<std::size_t>(of_few);
        auto const sorted = detector.query(spheres, collide::pairs(order::canonical)).to_host();
        CHECK((sorted.size() == size && std::equal(sorted.begin(), sorted.end(), expected.begin())));
        auto found = detector.query(spheres, collide::pairs()).to_host();
        std::sort(found.begin(), found.end());
        CHECK((found == sorted));
        CHECK(detector.query(spheres, collide::count()).total() == size);
      }
    }
  }
}

/// Verdicts that are given several at a time, and what the box of a triangle lets pass: near contact, and with radii
/// that are off by a part of 2^-24 to 2^-4.
template <class S>
void check_several(std::vector<tests::near_case> const& cases) {
  namespace detail = collide::detail;
  constexpr std::size_t lanes = detail::sphere_soa<S>::simd_width;
  std::size_t wrong = 0, sure = 0, lost = 0;
  detail::candidate_batch<S> batch;
  for (std::size_t first = 0; first < cases.size(); first += batch.capacity) {
    std::size_t const last = std::min(first + batch.capacity, cases.size());
    bool hits[batch.capacity];
    batch.size = 0;
    for (std::size_t i = first; i < last; ++i) {
      tests::narrow_case<S> made(cases[i]);
      if (i % 3 != 0) made.ball.radius *= 1 + std::ldexp(i % 3 == 1 ? S(1) : S(-1), -4 - static_cast<int>(i % 20));
      bool const hit = detail::intersects_exact(made.shape, made.ball).hit;
      hits[i - first] = hit;
      batch.add({}, made.shape, made.ball);
      S columns[5][lanes] = {};
      collide::id ids[lanes];
      detail::sphere_soa<S> const near{columns[0], columns[1], columns[2], columns[3], columns[4], ids};
      for (std::size_t k = 0; k < lanes; ++k) near.set(k, made.ball, 0);
      auto const box = detail::triangle_aabb_of(made.shape);
      bool const passes = near.reaching(box, 0) == 0xff && box.overlaps(made.ball.centre, made.ball.radius);
      lost += hit && !passes;
    }
    for (S const scale : {S(1), S(0x1p-12), S(0x1p12)}) {
      batch.filter_batch(
          [&](int k) { return detail::filter_branchless(batch.triangle_of(k), batch.sphere_of(k), scale); });
      for (std::size_t i = 0; i < last - first; ++i) {
        auto const v = static_cast<detail::verdict>(batch.verdicts[i]);
        sure += scale == 1 && (v == detail::verdict::hit || v == detail::verdict::miss);
        wrong += v == (hits[i] ? detail::verdict::miss : detail::verdict::hit);
      }
    }
  }
  CHECK(wrong == 0);
  CHECK(lost == 0);
  CHECK(sure > cases.size() / 20);
}

/// The same of balls that move, near contact somewhere on their way.
template <class S>
void check_several_ways(std::vector<tests::near_sweep> const& cases) {
  namespace detail = collide::detail;
  constexpr std::size_t lanes = detail::sphere_soa<S>::simd_width;
  std::size_t wrong = 0, lost = 0, sure[2] = {};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    tests::narrow_case<S> const made(cases[i]);
    auto const& move = cases[i].move;
    collide::moving_sphere<S> ball{made.ball, {static_cast<S>(move.x), static_cast<S>(move.y), static_cast<S>(move.z)}};
    if (i % 3 != 0) ball.radius *= 1 + std::ldexp(i % 3 == 1 ? S(1) : S(-1), -4 - static_cast<int>(i % 20));
    bool const hit = detail::intersects_exact(made.shape, ball).hit;
    auto const v = detail::filter_branchless(made.shape, collide::detail::swept_bounding_sphere(ball),
                                             detail::midpoint_sphere(ball));
    if (v != detail::verdict::uncertain) ++sure[v == detail::verdict::hit];
    wrong += v == (hit ? detail::verdict::miss : detail::verdict::hit);
    S columns[5][lanes] = {};
    collide::id ids[lanes];
    detail::sphere_soa<S> const near{columns[0], columns[1], columns[2], columns[3], columns[4], ids};
    auto const around = detail::swept_bounding_sphere(ball);
    for (std::size_t k = 0; k < lanes; ++k) near.set(k, around, 0);
    auto const box = detail::triangle_aabb_of(made.shape);
    lost += hit && !(near.reaching(box, 0) == 0xff && box.overlaps(around.centre, around.radius));
  }
  CHECK(wrong == 0);
  CHECK(lost == 0);
  CHECK(sure[0] > cases.size() / 1000);  // most of these are left to the swept test
}

/// The same of balls that are near contact in the middle of their way, where most are sure to touch or not.
template <class S>
void check_midway(std::vector<tests::near_case> const& cases) {
  namespace detail = collide::detail;
  std::mt19937 engine(67);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::size_t wrong = 0, hits = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    tests::narrow_case<S> const made(cases[i]);
    collide::moving_sphere<S> ball{made.ball, {S(0), S(0), S(0)}};
    S const length = ball.radius * std::ldexp(S(1), -static_cast<int>(i % 30));
    for (int k = 0; k < 3; ++k) ball.displacement[k] = static_cast<S>(uniform(engine)) * length;
    ball.centre -= ball.displacement / 2;
    ball.radius *= 1 + std::ldexp(S(i % 2 == 0 ? 1 : -1), -static_cast<int>(i / 30 % 30));
    auto const v =
        detail::filter_branchless(made.shape, detail::swept_bounding_sphere(ball), detail::midpoint_sphere(ball));
    hits += v == detail::verdict::hit;
    wrong += v == (detail::intersects_exact(made.shape, ball).hit ? detail::verdict::miss : detail::verdict::hit);
  }
  CHECK(wrong == 0);
  CHECK(hits > cases.size() / 20);
}

}  // namespace

TEST_CASE_TEMPLATE("sorted spheres: the same pairs, whoever looks for them and with any number of threads", S, float,
                   double) {
  SUBCASE("one radius") { check_sorted<S>(io::study_scene(30000, 1000, 1)); }
  SUBCASE("several grids") { check_sorted<S>(io::radii_scene(30000, 500, 2)); }
  SUBCASE("several levels") { check_sorted<S>(io::giant_scene(30000, 500, 3)); }
  SUBCASE("cells that wrap around") { check_sorted<S>(io::clusters_scene(20000, 500, 4)); }
  SUBCASE("everything in one cell") { check_sorted<S>(io::pile_scene(3000, 100, 5)); }
  SUBCASE("all spheres near") { check_sorted<S>(io::terrain_scene(30000, 1000, 6)); }
}

TEST_CASE("sorted spheres: a scene in other units has the same pairs") {
  numbers<float> made(io::study_scene(20000, 1000, 7));
  collide::detector<collide::bucket> detector(collide::host(1));
  auto const found = [&] {
    return detector.detect(made.mesh(), made.spheres(made.radii.size()), collide::pairs(collide::order::canonical))
        .to_host();
  };
  auto const expected = found();
  REQUIRE(expected.size() > 500);
  for (float const factor : {0x1p-10f, 0x1p-10f, 0x1p-20f, 0x1p60f}) {  // the last one is of 2^20
    for (auto* numbers : {&made.vertices, &made.centres, &made.radii})
      for (float& x : *numbers) x *= factor;
    CHECK(found() == expected);
  }
}

TEST_CASE_TEMPLATE("sorted spheres: a verdict that is given without branches is right, and a box loses nothing", S,
                   float, double) {
  check_several<S>(tests::near_contact<S>(61, 20000));
  check_several<S>(tests::ties<S>(62, 5000));
  check_several<S>(tests::mixed_exponents<S>(63, 5000));
}

TEST_CASE_TEMPLATE("sorted spheres: the same of spheres that move", S, float, double) {
  check_several_ways<S>(tests::near_sweeps<S>(64, 20000));
  check_several_ways<S>(tests::lattice_sweeps<S>(65, 5000));
  check_several_ways<S>(tests::mixed_sweeps<S>(66, 5000));
  check_midway<S>(tests::near_contact<S>(67, 20000));
}

TEST_CASE("sorted spheres: running sums, in parts or not") {
  for (std::size_t n : {0, 1, 16383, 16384, 16385, 100000, 3000001}) {
    std::vector<std::uint32_t> values(n);
    for (std::size_t i = 0; i < n; ++i) values[i] = static_cast<std::uint32_t>(i * 2654435761u >> 7);
    for (int threads : {1, 2, 5}) {
      auto sums = values;
      collide::detail::exclusive_scan(collide::host(threads), sums.data(), n);
      std::uint32_t sum = 0;
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < n; sum += values[i++]) wrong += sums[i] != sum;
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("sorted spheres: pairs in canonical order, whatever the number of spheres") {
  for (std::size_t spheres : {2047, 2048, 2049, 4095, 4096, 4097, 6000, 65537}) {
    std::vector<collide::pair> pairs;  // each sphere touches triangles 2 and 0; the last sphere comes first
    for (std::size_t i = spheres; i-- > 0;) {
      for (collide::id t : {2, 0}) pairs.push_back({static_cast<collide::id>(i), t});
    }
    auto expected = pairs;
    std::sort(expected.begin(), expected.end());
    for (int threads : {1, 3}) {
      auto sorted = pairs;
      collide::detail::sort_memory memory;
      collide::detail::sort_pairs(collide::host(threads), sorted.data(), sorted.size(), sorted.size(), spheres, 3,
                                  memory);
      CHECK(sorted == expected);
    }
  }
}
