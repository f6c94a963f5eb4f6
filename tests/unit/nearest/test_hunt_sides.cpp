/// Goes on for ten minutes: on which side of closed meshes points within a unit in the last place of their faces, edges
/// and corners are, how far, and which triangle is nearest, as queries say, against the oracle. Two environment
/// variables: COLLIDE_HUNT_SECONDS, 600 if not set; COLLIDE_HUNT_SEED, the first seed, 1 if not set.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "nearest/signed_queries.hpp"

namespace {

int from_environment(char const* name, int otherwise) {
  char const* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::atoi(text);
}

/// How many points there were, and how many were told wrongly.
struct tally {
  int points = 0, inside = 0, on_surface = 0, wrong_sides = 0, wrong_nearest = 0, wrong_distances = 0;
};

/// A ball, a cube, or one of them made a hundred times thinner along an axis; somewhere.
template <class S>
std::vector<collide::triangle<S>> closed_mesh(tests::dice& roll, double offset) {
  int const kind = roll.integer(0, 2), thin = roll.integer(0, 3);
  auto mesh = kind == 2 ? tests::unit_cube<double>() : tests::icosphere<double>(kind, 1, {0, 0, 0});
  double const away[3] = {offset + roll.uniform(-1, 1), offset + roll.uniform(-1, 1), offset + roll.uniform(-1, 1)};
  std::vector<collide::triangle<S>> all;
  for (auto const& t : tests::triangles_of(mesh)) {
    auto const place = [&](collide::vec3<double> v) {
      if (thin < 3) v[thin] *= 0.01;
      return collide::vec3<S>(S(v[0] + away[0]), S(v[1] + away[1]), S(v[2] + away[2]));
    };
    all.push_back({place(t.a), place(t.b), place(t.c)});
  }
  return all;
}

/// The nearest triangle, of those whose box is near: exact distances are compared.
template <class S>
collide::id nearest_of_oracle(std::vector<collide::triangle<S>> const& mesh, collide::vec3<S> const& p, double near) {
  collide::id best = collide::no_id;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    auto const& t = mesh[i];
    bool is_near = true;
    for (int k = 0; k < 3; ++k) {
      double const low = double(std::min({t.a[k], t.b[k], t.c[k]})), high = double(std::max({t.a[k], t.b[k], t.c[k]}));
      is_near = is_near && double(p[k]) >= low - near && double(p[k]) <= high + near;
    }
    if (!is_near) continue;
    if (best == collide::no_id ||
        oracle::compare_distances(tests::to_oracle(t), tests::to_oracle(mesh[best]), tests::to_oracle(p)) < 0)
      best = static_cast<collide::id>(i);
  }
  return best;
}

template <class S>
void judge(tests::dice& roll, double offset, tally& all) {
  auto const mesh = closed_mesh<S>(roll, offset);
  std::vector<oracle::triangle> exact;
  for (auto const& t : mesh) exact.push_back(tests::to_oracle(t));
  std::vector<collide::vec3<S>> points;
  for (int i = 0; i < 100; ++i) points.push_back(tests::point_at_surface(mesh, roll, 1));
  double const near =
      64 * double(std::numeric_limits<S>::epsilon()) * (offset + 2);  // than 2 units in three directions
  auto const found = tests::ask<collide::bvh>(collide::host(1), mesh, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    auto const p = tests::to_oracle(points[i]);
    auto const nearest = nearest_of_oracle(mesh, points[i], near);
    REQUIRE(nearest != collide::no_id);
    auto const expected = static_cast<S>(oracle::closest(exact[nearest], p).distance);
    REQUIRE(double(expected) < near);
    bool const inside = oracle::inside(exact, p), on_it = expected == 0;
    auto const& d = found.distances[i];
    S const magnitude = std::abs(d.distance);
    ++all.points;
    all.inside += inside;
    all.on_surface += on_it;
    all.wrong_sides +=
        (found.inside[i] != 0) != inside || (d.distance < 0) != (inside && !on_it) || (d.distance == 0) != on_it;
    all.wrong_nearest += d.triangle != nearest;
    all.wrong_distances += magnitude != expected && std::nextafter(magnitude, expected) != expected;
  }
}

}  // namespace

TEST_CASE("hunt: sides: points within a unit in the last place of closed meshes") {
  using clock = std::chrono::steady_clock;
  auto const end = clock::now() + std::chrono::seconds(from_environment("COLLIDE_HUNT_SECONDS", 600));
  int seed = from_environment("COLLIDE_HUNT_SEED", 1);
  double const offsets[3] = {0, 1e2, 1e5};
  tally all[2][3];
  do {
    for (int k = 0; k < 3; ++k) {
      INFO("COLLIDE_HUNT_SEED=" << seed << " COLLIDE_HUNT_SECONDS=0: offset " << offsets[k]);
      tests::dice roll(static_cast<unsigned>(seed));
      judge<float>(roll, offsets[k], all[0][k]);
      judge<double>(roll, offsets[k], all[1][k]);
      for (auto const& of_scalar : all) {
        REQUIRE(of_scalar[k].wrong_sides == 0);
        REQUIRE(of_scalar[k].wrong_nearest == 0);
        REQUIRE(of_scalar[k].wrong_distances == 0);
      }
    }
    ++seed;
  } while (clock::now() < end);
  for (int s = 0; s < 2; ++s)
    for (int k = 0; k < 3; ++k)
      MESSAGE(std::string(s == 0 ? "float" : "double")
              << " at " << offsets[k] << ": " << all[s][k].points << " points, " << all[s][k].inside << " inside, "
              << all[s][k].on_surface << " on the surface: none is wrong");
}
