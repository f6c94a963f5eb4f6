/// Queries of the sinks `contains` and `signed_distance` in a space; instantiated by test_signed_queries.cpp and
/// test_signed_queries_cuda.cpp.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/bvh.cuh>
#include <collide/sinks/contains.hpp>
#include <collide/sinks/signed_distance.hpp>

#include "nearest/point_cases.hpp"

namespace tests {

/// An array of the host, and its copy in memory of a space.
template <class T, class Space>
T const* in_space(Space const& space, std::vector<T> const& from, collide::buffer<T>& memory) {
  T* const to = memory.reserve(space.resource(), from.size());
  space.copy_from_host(to, from.data(), from.size());
  return to;
}

template <class S>
struct signed_answers {
  std::vector<std::uint8_t> inside;
  std::vector<collide::signed_nearest_triangle<S>> distances;
};

/// Asks for the mesh as a soup: equal corners are one.
template <class BroadPhase, class Precision = collide::exact, class S, class Space>
signed_answers<S> ask(Space const& space, std::vector<collide::triangle<S>> const& mesh,
                      std::vector<collide::vec3<S>> const& points, S reach = std::numeric_limits<S>::infinity()) {
  std::vector<S> corners, coordinates;
  auto const append = [](std::vector<S>& to, collide::vec3<S> const& v) {
    for (int k = 0; k < 3; ++k) to.push_back(v[k]);
  };
  for (auto const& t : mesh) append(corners, t.a), append(corners, t.b), append(corners, t.c);
  for (auto const& p : points) append(coordinates, p);
  collide::buffer<S> mesh_memory, point_memory;
  collide::detector<BroadPhase, collide::karabassi<Precision>, Space, S> detector(space);
  detector.build(collide::triangle_soup(in_space(space, corners, mesh_memory), mesh.size()));
  auto const view = collide::points(in_space(space, coordinates, point_memory), points.size());
  return {detector.query(view, collide::contains()).to_host(),
          detector.query(view, collide::signed_distance<S>(reach)).to_host()};
}

/// The same without a detector: every triangle, one after the other.
template <class S>
signed_answers<S> ask_plainly(std::vector<collide::triangle<S>> const& mesh,
                              std::vector<collide::vec3<S>> const& points) {
  signed_answers<S> answers;
  for (auto const& p : points) {
    collide::detail::nearest_search<S, collide::exact> nearest(p, std::numeric_limits<S>::infinity());
    collide::detail::ray_parity<S> parity(p);
    for (std::size_t i = 0; i < mesh.size(); ++i) {
      nearest.consider(mesh[i], static_cast<collide::id>(i));
      parity.consider(mesh[i]);
    }
    answers.inside.push_back(parity.inside());
    answers.distances.push_back({nearest.result(), {0, 0, 0}});
    if (parity.inside() && !parity.on_surface()) answers.distances.back().distance *= -1;
  }
  return answers;
}

template <class S>
bool same_bits(collide::nearest_triangle<S> const& a, collide::nearest_triangle<S> const& b) {
  return std::memcmp(a.point.data(), b.point.data(), 3 * sizeof(S)) == 0 &&
         std::memcmp(a.barycentric.data(), b.barycentric.data(), 3 * sizeof(S)) == 0 &&
         std::memcmp(&a.distance, &b.distance, sizeof(S)) == 0 && a.triangle == b.triangle && a.feature == b.feature &&
         a.feature_index == b.feature_index;
}

/// Points at the surface of closed meshes, near them and far from them: what a space finds is what is found plainly,
/// bit for bit, and gradients point away from the inside.
template <class BroadPhase, class S, class Space>
void check_signed_queries(Space const& space, int n) {
  for (double const offset : {0.0, 1e2, 1e5}) {
    CAPTURE(offset);
    dice roll(9);
    auto const mesh = triangles_of(icosphere<S>(2, 1, {offset, offset, offset}));
    std::vector<collide::vec3<S>> points;
    for (int i = 0; i < n; ++i) {
      points.push_back(point_at_surface(mesh, roll, i % 3));
      auto const p = roll.in_cube(i % 2 == 0 ? 1 : 50);
      points.push_back(from_oracle<S>({offset + p.x, offset + p.y, offset + p.z}));
    }
    auto const found = ask<BroadPhase>(space, mesh, points);
    auto const plainly = ask_plainly(mesh, points);
    int wrong_side = 0, wrong_distance = 0, wrong_gradient = 0, inside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      auto const& d = found.distances[i];
      inside += found.inside[i];
      wrong_side += found.inside[i] != plainly.inside[i] || (found.inside[i] != 0) != (d.distance <= 0);
      wrong_distance += !same_bits<S>(d, plainly.distances[i]);
      collide::vec3<double> const outward = d.point.template cast<double>() - collide::vec3<double>::Constant(offset),
                                  gradient = d.gradient.template cast<double>();
      bool const rounded_away = std::abs(double(d.distance)) < 1e-12;  // in double, at 1e5
      wrong_gradient += !(std::abs(gradient.norm() - 1) < 1e-6) || !(gradient.dot(outward) > (rounded_away ? -1 : 0));
    }
    CHECK(wrong_side == 0);
    CHECK(wrong_distance == 0);
    CHECK(wrong_gradient == 0);
    CHECK(inside > n / 2);
    CHECK(inside < 2 * n);
  }
}

/// A ball drawn out into a needle across the axes, whose triangles a tree cuts into pieces: each counts once.
template <class BroadPhase, class S, class Space>
void check_signed_queries_of_needles(Space const& space, int n) {
  dice roll(10);
  auto needle = icosphere<S>(2, 1, {0, 0, 0});
  for (std::size_t i = 0; i < needle.vertices.size(); i += 3) {
    S* const v = &needle.vertices[i];
    S const along = 40 * (v[0] + v[1] + v[2]);
    for (int k = 0; k < 3; ++k) v[k] += along;
  }
  auto const mesh = triangles_of(needle);
  std::vector<collide::vec3<S>> points;
  for (int i = 0; i < n; ++i) {
    points.push_back(point_at_surface(mesh, roll, 1));
    points.push_back((mesh[std::size_t(roll.integer(0, 319))].a + mesh[std::size_t(roll.integer(0, 319))].b) * S(0.5));
  }
  auto const found = ask<BroadPhase>(space, mesh, points);
  auto const plainly = ask_plainly(mesh, points);
  CHECK(found.inside == plainly.inside);
  int wrong = 0, inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    wrong += !same_bits<S>(found.distances[i], plainly.distances[i]);
    inside += found.inside[i];
  }
  CHECK(wrong == 0);
  CHECK(inside > n / 2);
  CHECK(inside < 2 * n);
}

/// Cases from public threads about other libraries: rays through corners and edges, and in the planes of faces.
template <class BroadPhase, class S, class Space>
void check_known_situations(Space const& space) {
  using points = std::vector<collide::vec3<S>>;
  auto const cube = triangles_of(unit_cube<S>());
  auto const at_corner = ask<BroadPhase>(space, cube, points{{-1, -1, 0}});
  CHECK(at_corner.inside[0] == 0);
  CHECK(at_corner.distances[0].distance == std::sqrt(S(2)));
  CHECK(at_corner.distances[0].feature == collide::feature::vertex);

  auto const ball = triangles_of(icosphere<S>(2, 2, {0, 0, 0}));
  auto const axes = ask<BroadPhase>(space, ball, points{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 3}, {0, 0, -3}});
  CHECK(axes.inside == std::vector<std::uint8_t>{1, 1, 1, 0, 0});

  std::vector<collide::triangle<S>> const tetrahedron{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                                                      {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                                                      {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                                      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  points grid;
  for (int x = -8; x <= 12; ++x)
    for (int y = -8; y <= 12; ++y)
      for (int z = -8; z <= 12; ++z) grid.push_back({S(x) / 4, S(y) / 4, S(z) / 4});
  auto const around = ask<BroadPhase>(space, tetrahedron, grid);
  int wrong = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    bool const inside = grid[i].minCoeff() >= 0 && grid[i].sum() <= 1;
    bool const on_it = inside && (grid[i].minCoeff() == 0 || grid[i].sum() == 1);
    wrong += (around.inside[i] != 0) != inside || (around.distances[i].distance < 0) != (inside && !on_it) ||
             (around.distances[i].distance == 0) != on_it;
  }
  CHECK(wrong == 0);

  auto twice = cube;
  for (auto& t : twice) t = {t.a * S(2), t.b * S(2), t.c * S(2)};
  auto const in_planes = ask<BroadPhase>(space, twice, points{{3, 2, 2}, {1, 1, 1}, {2, 2, 2}, {1, 1, S(1.5)}});
  CHECK(in_planes.inside == std::vector<std::uint8_t>{0, 1, 1, 1});
  CHECK(in_planes.distances[0].distance == 1);
  CHECK(in_planes.distances[1].distance == -1);
  CHECK(in_planes.distances[2].distance == 0);
  CHECK(in_planes.distances[3].distance == S(-0.5));
  CHECK(in_planes.distances[3].gradient == collide::vec3<S>(0, 0, 1));

  // a ridge above the point, from outside: the ray along +z grazes it
  std::vector<collide::triangle<S>> const roof{{{-1, 0, 2}, {1, 0, 2}, {0, 1, 1}},
                                               {{-1, 0, 2}, {0, 1, 1}, {-1, 0, 3}},
                                               {{1, 0, 2}, {-1, 0, 2}, {-1, 0, 3}},
                                               {{1, 0, 2}, {-1, 0, 3}, {0, 1, 1}}};
  CHECK(ask<BroadPhase>(space, roof, points{{0, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 1, 0}, {S(0.5), S(0.5), 0}}).inside ==
        std::vector<std::uint8_t>(5, 0));
}

/// No triangles, no points, points that are not finite, and a largest distance.
template <class BroadPhase, class S, class Space>
void check_unusual_signed_queries(Space const& space) {
  constexpr S nan = std::numeric_limits<S>::quiet_NaN(), infinity = std::numeric_limits<S>::infinity();
  using points = std::vector<collide::vec3<S>>;
  auto const cube = triangles_of(unit_cube<S>());
  auto const none = ask<BroadPhase>(space, {}, points{{0, 0, 0}});
  CHECK(none.inside[0] == 0);
  CHECK(none.distances[0].distance == infinity);
  CHECK(none.distances[0].triangle == collide::no_id);
  CHECK(ask<BroadPhase>(space, cube, points{}).inside.empty());
  auto const not_finite = ask<BroadPhase>(space, cube, points{{nan, 0, 0}, {S(0.5), S(0.5), -infinity}});
  CHECK(not_finite.inside == std::vector<std::uint8_t>{0, 0});
  CHECK(not_finite.distances[1].distance == infinity);
  CHECK(std::isnan(not_finite.distances[0].gradient.x()));
  auto const limited =
      ask<BroadPhase>(space, cube, points{{S(0.5), S(0.5), S(0.5)}, {3, 0, 0}, {S(1.25), 0, 0}}, S(0.25));
  CHECK(limited.distances[0].distance == -infinity);
  CHECK(limited.distances[1].distance == infinity);
  CHECK(limited.distances[2].distance == S(0.25));
}

}  // namespace tests
