/// Queries with spheres that move, in a space, against the narrow phase alone; instantiated by test_swept_queries.cpp
/// and test_swept_queries_cuda.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/earliest.hpp>
#include <collide/sinks/impacts.hpp>

namespace tests {

/// Triangles and moving spheres on the host.
template <class S>
struct moving_scene {
  std::vector<S> corners, centres, radii, displacements;
  bool one_radius = false;  ///< and the view says so

  collide::mesh_view<S> mesh() const { return collide::triangle_soup(corners.data(), corners.size() / 9); }
  collide::sphere_view<S> spheres() const {
    return one_radius ? collide::spheres_xyz(centres.data(), radii.size(), radii[0])
                      : collide::spheres_xyz(centres.data(), radii.size(), radii.data());
  }
  collide::moving_sphere_view<S> moving() const { return collide::with_displacements(spheres(), displacements.data()); }
};

/// How a random scene is made.
struct motion {
  double size = 12;     ///< of the scene
  double triangle = 2;  ///< and of its triangles, some 16 times smaller
  double radius = 1;    ///< the largest
  double spread = 1;    ///< how much smaller radii may be
  double longest = 3;   ///< of a way on an axis; most are shorter
  double offset = 0;    ///< from the origin
  int triangles = 300, spheres = 300;
  bool one_radius = false;  ///< in the view, too
};

template <class S>
moving_scene<S> random_motion(unsigned seed, motion const& m) {
  std::mt19937 engine(seed);
  auto const uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  moving_scene<S> made;
  made.one_radius = m.one_radius;
  for (int i = 0; i < m.triangles; ++i) {
    double const at[] = {uniform(-m.size, m.size), uniform(-m.size, m.size), uniform(-m.size, m.size)};
    double const size = m.triangle * std::exp2(uniform(-4, 0));
    for (std::size_t k = 0; k < 9; ++k)
      made.corners.push_back(static_cast<S>(m.offset + at[k % 3] + uniform(-size, size)));
  }
  for (int i = 0; i < m.spheres; ++i) {
    double const length = m.longest * std::exp2(uniform(-6, 0));
    int const kind = std::uniform_int_distribution<int>(0, 7)(engine);  // some rest, some move along an axis
    for (int k = 0; k < 3; ++k) {
      made.centres.push_back(static_cast<S>(m.offset + uniform(-1.2 * m.size, 1.2 * m.size)));
      bool const still = kind == 0 || (kind == 1 && k != i % 3);
      made.displacements.push_back(still ? S(0) : static_cast<S>(uniform(-length, length)));
    }
    made.radii.push_back(static_cast<S>(m.radius * std::exp2(uniform(-std::log2(m.spread), 0))));
  }
  return made;
}

/// The copy of a scene in the space's memory.
template <class S>
class placed_scene {
 public:
  template <class Space>
  placed_scene(Space const& space, moving_scene<S> const& s) {
    auto const put = [&](collide::buffer<S>& to, std::vector<S> const& from) {
      to.reserve(space.resource(), from.size() + 1);
      space.copy_from_host(to.data(), from.data(), from.size());
    };
    put(corners_, s.corners), put(centres_, s.centres), put(radii_, s.radii), put(displacements_, s.displacements);
    mesh = collide::triangle_soup(static_cast<S const*>(corners_.data()), s.corners.size() / 9);
    auto const* const centres = static_cast<S const*>(centres_.data());
    auto const spheres = s.one_radius
                             ? collide::spheres_xyz(centres, s.radii.size(), s.radii[0])
                             : collide::spheres_xyz(centres, s.radii.size(), static_cast<S const*>(radii_.data()));
    moving = collide::with_displacements(spheres, static_cast<S const*>(displacements_.data()));
  }

  collide::mesh_view<S> mesh;
  collide::moving_sphere_view<S> moving;

 private:
  collide::buffer<S> corners_, centres_, radii_, displacements_;
};

/// All pairs that the narrow phase accepts, in canonical order.
template <class NarrowPhase, class S>
std::vector<collide::pair> pairs_that_touch(moving_scene<S> const& made) {
  auto const mesh = made.mesh();
  auto const balls = made.moving();
  std::vector<collide::pair> found;
  for (collide::id s = 0; s < balls.size(); ++s)
    for (collide::id t = 0; t < mesh.size(); ++t)
      if (NarrowPhase::intersects(mesh[t], balls[s])) found.push_back({s, t});
  return found;
}

/// Checks pairs, counts, impacts and first impacts of one composition.
template <class NarrowPhase, class Space, class BroadPhase, class S>
void check_motion(Space const& space, BroadPhase const& broad, moving_scene<S> const& made,
                  std::vector<collide::pair> const& expected) {
  placed_scene<S> const scene(space, made);
  collide::detector<BroadPhase, NarrowPhase, Space, S> detector(space, broad);
  CHECK((detector.detect(scene.mesh, scene.moving, collide::pairs(collide::order::canonical)).to_host() == expected));
  if constexpr (Space::host_accessible)  // on CUDA it would be some more minutes of compilation
    CHECK(detector.query(scene.moving, collide::count()).total() == expected.size());

  auto const impacts = detector.query(scene.moving, collide::impacts<S>(collide::order::canonical)).to_host();
  REQUIRE(impacts.size() == expected.size());
  auto const first = detector.query(scene.moving, collide::earliest<S>()).to_host();
  REQUIRE(first.size() == made.radii.size());
  std::vector<collide::first_impact<S>> best(first.size(), {collide::no_id, std::numeric_limits<S>::infinity()});
  auto const first_impacts = detector.query(scene.moving, collide::earliest_impact<S>()).to_host();
  REQUIRE(first_impacts.size() == first.size());
  std::vector<collide::impact<S>> best_impacts = first_impacts;  // of those that touch nothing as they are
  std::size_t different = 0;
  for (auto const& i : impacts) {
    auto wanted = NarrowPhase::impact_of(made.mesh()[i.contact.triangle], made.moving()[i.contact.sphere]);
    wanted.contact.sphere = i.contact.sphere;
    wanted.contact.triangle = i.contact.triangle;
    different += std::memcmp(&i, &wanted, sizeof i) != 0;
    auto& b = best[i.contact.sphere];
    if (i.time < b.time) {
      b = {i.contact.triangle, i.time};
      best_impacts[i.contact.sphere] = i;
    }
  }
  for (std::size_t s = 0; s < first.size(); ++s) {
    auto const& i = first_impacts[s];
    different += std::memcmp(&i, &best_impacts[s], sizeof i) != 0;
    bool const touches = best[s].triangle != collide::no_id;
    different += i.contact.triangle != best[s].triangle || i.time != best[s].time;
    different += i.contact.sphere != (touches ? s : collide::no_id) || std::isnan(i.contact.point.x()) == touches;
  }
  CHECK(different == 0);
  CHECK(std::equal(first.begin(), first.end(), best.begin(),
                   [](auto const& x, auto const& y) { return x.triangle == y.triangle && x.time == y.time; }));
}

/// A few spheres, for tools that are slow.
template <class S, class Space>
void check_few_motions(Space const& space) {
  using narrow_phase = collide::karabassi_swept<collide::exact>;
  motion few;
  few.triangles = few.spheres = 40;
  few.size = 4;
  auto const made = random_motion<S>(1, few);
  auto const expected = pairs_that_touch<narrow_phase>(made);
  CHECK(expected.size() > 20);
  check_motion<narrow_phase>(space, collide::bucket(), made, expected);
}

/// Each broad phase in a space, on scenes of many kinds.
template <class S, class Space, class Precision = collide::exact>
void check_motions(Space const& space) {
  using narrow_phase = collide::karabassi_swept<Precision>;
  unsigned seed = 1;
  auto const check = [&](motion const& m, collide::bucket const& options = {}) {
    CAPTURE(m.longest);
    CAPTURE(m.offset);
    CAPTURE(options.cell_width);
    auto const made = random_motion<S>(++seed, m);
    auto const expected = pairs_that_touch<narrow_phase>(made);
    CHECK(expected.size() > 20);
    check_motion<narrow_phase>(space, collide::all_pairs(), made, expected);
    check_motion<narrow_phase>(space, options, made, expected);
    check_motion<narrow_phase>(space, collide::bvh(), made, expected);
  };
  for (double const longest : {0.0, 0.1, 3.0, 30.0, 1000.0}) {
    motion m;
    m.longest = longest;
    check(m);
    m.offset = 1e4;
    check(m);
  }
  for (double const longest : {0.0, 0.1, 1.0, 10.0}) {  // of many spheres the host sorts those that do not move far
    motion m;
    m.one_radius = true;
    m.triangles = 60;
    m.spheres = 2500;
    m.longest = longest;
    check(m);
    m.offset = 1e4;
    check(m);
  }
  motion many_radii;
  many_radii.radius = 8;
  many_radii.spread = 64;
  check(many_radii);
  check(many_radii, {0.5});      // ways through many cells
  check(many_radii, {100});      // and through one
  check(many_radii, {0, 4096});  // no room for a grid
  motion fast;
  fast.longest = 1e7;  // beyond all cells, there and back
  check(fast);
  motion wide;  // cell coordinates wrap around
  wide.size = 2000;
  wide.triangle = 500;
  wide.longest = 2000;
  wide.radius = 100;
  check(wide);
  check(wide, {20});
}

}  // namespace tests
