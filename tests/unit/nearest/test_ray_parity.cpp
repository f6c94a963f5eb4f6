/// Inside and outside of closed meshes against the oracle.
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <doctest/doctest.h>

#include <collide/sinks/contains.hpp>

#include "../../flush_to_zero.hpp"
#include "compared.hpp"
#include "nearest/point_cases.hpp"

namespace {

template <class S>
using triangles = std::vector<collide::triangle<S>>;

template <class S>
collide::detail::ray_parity<S> parity(triangles<S> const& mesh, collide::vec3<S> const& p) {
  collide::detail::ray_parity<S> found(p);
  for (auto const& t : mesh) found.consider(t);
  return found;
}

template <class S>
collide::detail::ray_parity<S> parity_in_lanes(triangles<S> const& mesh, collide::vec3<S> const& p) {
  collide::detail::ray_parity_in_lanes<S> found(p);
  for (auto const& t : mesh) found.consider(t);
  return found.result();
}

template <class S>
std::vector<oracle::triangle> to_oracle(triangles<S> const& mesh) {
  std::vector<oracle::triangle> all;
  for (auto const& t : mesh) all.push_back(tests::to_oracle(t));
  return all;
}

/// The triangles of a mesh with their corners mapped.
template <class S, class F>
triangles<S> mapped(triangles<S> const& mesh, F const& f) {
  triangles<S> all;
  for (auto const& t : mesh) all.push_back({f(t.a), f(t.b), f(t.c)});
  return all;
}

/// How many points are told wrongly; counts those inside, and on the surface.
struct tally {
  int cases = 0, wrong = 0, inside = 0, on_surface = 0;

  template <class S>
  void add(triangles<S> const& mesh, std::vector<oracle::triangle> const& exact, collide::vec3<S> const& p) {
    bool const expected = oracle::inside(exact, tests::to_oracle(p));
    bool touched = false;
    for (auto const& t : exact) touched = touched || oracle::hit(t, {tests::to_oracle(p), 0});
    ++cases;
    inside += expected;
    on_surface += touched;
    for (auto const& found : {parity(mesh, p), parity_in_lanes(mesh, p)})
      wrong += found.inside() != expected || found.on_surface() != touched;
  }
};

}  // namespace

TEST_CASE_TEMPLATE("parity: points at the surface of closed meshes, at the origin and far from it", S, float, double) {
  for (double const offset : {0.0, 1e2, 1e5}) {
    CAPTURE(offset);
    tests::dice roll(1);
    auto const mesh = tests::triangles_of(tests::icosphere<S>(1, 1, {offset, offset, offset}));
    auto const exact = to_oracle(mesh);
    tally all;
    for (int i = 0; i < 1000; ++i) all.add<S>(mesh, exact, tests::point_at_surface(mesh, roll, i % 3));
    CHECK(all.wrong == 0);
    tests::compared<S>("wrong sides of closed meshes", "crossings of a ray, in rational numbers", all.wrong, 0,
                       std::size_t(all.cases));
    CHECK(all.on_surface > all.cases / 20);
    CHECK(all.inside > all.cases / 4);
    CHECK(all.inside < all.cases);
  }
}

TEST_CASE_TEMPLATE("hunt: parity: half a million points at the surface of closed meshes", S, float, double) {
  for (double const offset : {0.0, 1e2, 1e5}) {
    CAPTURE(offset);
    tests::dice roll(11);
    auto const mesh = tests::triangles_of(tests::icosphere<S>(0, 1, {offset, offset, offset}));
    auto const exact = to_oracle(mesh);
    tally all;
    for (int i = 0; i < 83334; ++i) all.add<S>(mesh, exact, tests::point_at_surface(mesh, roll, i % 3));
    CHECK(all.wrong == 0);
  }
}

TEST_CASE_TEMPLATE("parity: grids of points in the planes and on the edges of boxes", S, float, double) {
  auto const cube = tests::triangles_of(tests::unit_cube<S>());
  // a box turned by 45 degrees has edges, and a pyramid a corner, above points of the grid
  auto const turned = mapped(cube, [](collide::vec3<S> const& v) {
    return collide::vec3<S>(v.x() - v.y() + S(0.5), v.x() + v.y() - S(0.5), v.z());
  });
  auto const tower =
      mapped(cube, [](collide::vec3<S> const& v) { return v.z() == 0 ? v : collide::vec3<S>(S(0.5), S(0.5), 1); });
  for (auto const& mesh : {cube, turned, tower}) {
    auto const exact = to_oracle(mesh);
    tally all;
    for (int x = -3; x <= 7; ++x)
      for (int y = -3; y <= 7; ++y)
        for (int z = -3; z <= 7; ++z) all.add<S>(mesh, exact, {S(x) / 4, S(y) / 4, S(z) / 4});
    CHECK(all.wrong == 0);
    CHECK(all.on_surface > 20);
    CHECK(all.inside > 30);
  }
}

TEST_CASE_TEMPLATE("parity: closed meshes of small integers that cut themselves, with flat triangles", S, float,
                   double) {
  tests::dice roll(3);
  tally all;
  for (int i = 0; i < 200; ++i) {
    auto corner = [&] {
      return collide::vec3<S>(S(roll.integer(-3, 3)), S(roll.integer(-3, 3)), S(roll.integer(-3, 3)));
    };
    auto const octahedron = tests::triangles_of(tests::icosphere<S>(0, 1, {0, 0, 0}));
    std::vector<collide::vec3<S>> from, to;
    auto const mesh = mapped(octahedron, [&](collide::vec3<S> const& v) {
      for (std::size_t k = 0; k < from.size(); ++k)
        if (from[k] == v) return to[k];
      from.push_back(v);
      to.push_back(corner());
      return to.back();
    });
    auto const exact = to_oracle(mesh);
    for (int k = 0; k < 20; ++k) all.add<S>(mesh, exact, corner() * S(0.5));
  }
  CHECK(all.wrong == 0);
  CHECK(all.inside > all.cases / 20);
  CHECK(all.on_surface > all.cases / 40);
}

TEST_CASE_TEMPLATE("parity: the largest and the smallest coordinates", S, float, double) {
  for (double const scale :
       {double(std::numeric_limits<S>::denorm_min()) * 16, double(std::numeric_limits<S>::max()) / 4}) {
    CAPTURE(scale);
    tests::dice roll(4);
    auto const ball = tests::icosphere<double>(0, 2, {0, 0, 0});
    triangles<S> mesh;
    for (std::size_t i = 0; i < ball.size(); ++i) {
      auto const t = ball[i];
      auto const at = [&](oracle::point const& p) {
        return collide::vec3<S>(S(p.x * scale), S(p.y * scale), S(p.z * scale));
      };
      mesh.push_back({at(t.a), at(t.b), at(t.c)});
    }
    auto const exact = to_oracle(mesh);
    tally all;
    for (int i = 0; i < 60; ++i) {
      auto const p = roll.in_cube(2.2);
      all.add<S>(mesh, exact, {S(p.x * scale), S(p.y * scale), S(p.z * scale)});
      all.add<S>(mesh, exact, tests::point_at_surface(mesh, roll, 1));
    }
    CHECK(all.wrong == 0);
    CHECK(all.inside > all.cases / 5);
    CHECK(all.inside < all.cases);
  }
}

TEST_CASE_TEMPLATE("parity: what doubles decide is so, beside edges and the plane, whatever the exponents", S, float,
                   double) {
  tests::dice roll(12);
  int decided = 0, wrong = 0, decided_in_lanes = 0;
  for (int n = 0; n < 40000; ++n) {
    S const scale = std::ldexp(S(1), roll.integer(-140, 100)), least = std::numeric_limits<S>::denorm_min();
    auto const corner = [&] {
      auto const at = [&] { return n % 3 == 0 ? S(roll.integer(-3, 3)) : S(roll.integer(-4000, 4000)) / 999; };
      return collide::vec3<S>(at() * scale, at() * (n % 5 == 0 ? least : scale), at() * scale);
    };
    collide::triangle<S> const t{corner(), corner(), corner()};
    S const v = S(roll.integer(0, 8)) / 8, w = n % 2 == 0 ? 0 : (1 - v) * S(roll.integer(0, 8)) / 8;
    collide::vec3<S> p = t.a * (1 - v - w) + t.b * v + t.c * w;
    S const step = scale * std::ldexp(S(1), -roll.integer(8, std::numeric_limits<S>::digits));
    for (int k = 0; k < 3; ++k) p[k] += step * S(roll.integer(-2, 2));
    bool on_line;
    auto const expected = collide::detail::cross_ray(collide::detail::widened(t), collide::detail::widened(p), on_line);
    for (bool const flushed : {false, true}) {
      auto crossing = collide::detail::ray_crossing::none;
      bool known;
      std::int32_t in_lane;
      {
        std::optional<tests::flush_to_zero> flush;
        if (flushed) flush.emplace();
        known = collide::detail::cross_ray_in_double(t, p, crossing);
        in_lane = collide::detail::cross_ray_in_lane(t, p[0], p[1], p[2]);
      }
      decided_in_lanes += in_lane >= 0;
      wrong += in_lane >= 0 && (in_lane == 1) != (expected == collide::detail::ray_crossing::above);
      decided += known;
      wrong += known && crossing != expected;
    }
  }
  CHECK(decided > 20000);
  CHECK(decided_in_lanes > 4000);
  CHECK(wrong == 0);
}

TEST_CASE_TEMPLATE("parity: what is not finite", S, float, double) {
  auto mesh = tests::triangles_of(tests::unit_cube<S>());
  constexpr S nan = std::numeric_limits<S>::quiet_NaN(), infinity = std::numeric_limits<S>::infinity();
  CHECK_FALSE(parity<S>(mesh, {nan, S(0.5), S(0.5)}).inside());
  CHECK_FALSE(parity<S>(mesh, {S(0.5), S(0.5), -infinity}).inside());
  mesh.push_back({{0, 0, 5}, {nan, 0, 5}, {0, 1, 5}});
  mesh.push_back({{-9, -9, 5}, {9, -9, 5}, {0, infinity, 5}});
  CHECK(parity<S>(mesh, {S(0.5), S(0.25), S(0.5)}).inside());
  CHECK_FALSE(parity_in_lanes<S>(mesh, {nan, S(0.5), S(0.5)}).inside());
  CHECK_FALSE(parity_in_lanes<S>(mesh, {S(0.5), S(0.5), -infinity}).inside());
  CHECK(parity_in_lanes<S>(mesh, {S(0.5), S(0.25), S(0.5)}).inside());
}
