/// Functions called for each hit, by many threads at once; instantiated by test_visit.cpp and test_visit_cuda.cpp.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include <collide/spaces/atomic_add.hpp>

#include "compositions.hpp"
#include "scenes.hpp"

namespace tests {

/// Sums over all hits, in memory of a space.
struct sums {
  std::uint32_t hits, spheres;
  std::int32_t below;          ///< 0
  std::uint64_t hits_64, old;  ///< the second: of what atomic_add returns
  std::int64_t depth;          ///< in units of 2^-32
  float hits_float;
  double hits_double;
};

/// Adds each hit.
struct add_up {
  sums* to;

  template <class Hit>
  COLLIDE_HD void operator()(Hit const& hit) const {
    auto const before = collide::atomic_add(&to->hits, 1u);
    collide::atomic_add(&to->spheres, hit.sphere);
    collide::atomic_add(&to->below, -1);
    collide::atomic_add(&to->hits_64, 1);
    collide::atomic_add(&to->old, before);
    collide::atomic_add(&to->depth, static_cast<std::int64_t>(double(hit.contact().depth) * 4294967296.0));
    collide::atomic_add(&to->hits_float, 1);
    collide::atomic_add(&to->hits_double, 1);
  }
};

/// A scene with many hits, in memory of a space.
template <class Space>
class crowded_scene {
 public:
  explicit crowded_scene(Space const& space) : space_{space} {
    auto const cube = unit_cube<float>();
    auto const balls = spheres_near(cube, 3, 20000, 0.6, 0.5);
    mesh = collide::indexed_mesh(vertices_.assign(space_, cube.vertices), cube.vertices.size() / 3,
                                 corners_.assign(space_, cube.corners), cube.size());
    spheres = collide::spheres_xyz(static_cast<float const*>(centres_.assign(space_, balls.centres)), balls.size(),
                                   static_cast<float const*>(radii_.assign(space_, balls.radii)));
  }

  collide::mesh_view<float> mesh;
  collide::sphere_view<float> spheres;

  /// Sums of nothing yet, in memory of the space.
  sums* begin() {
    sums const none{};
    return sums_ = memory_.assign(space_, &none, 1);
  }

  /// Those sums when f has been called for each hit.
  template <class F>
  sums end(F const& f) {
    collide::detector<collide::bucket, collide::karabassi<>, Space> detector(space_);
    detector.detect(mesh, spheres, collide::visit(f));
    sums found;
    space_.copy_to_host(&found, sums_, 1);
    return found;
  }

 private:
  Space space_;
  array<float> vertices_, centres_, radii_;
  array<std::uint32_t> corners_;
  array<sums> memory_;
  sums* sums_ = nullptr;
};

/// The sums are those of the pairs, whatever the number of threads.
template <class Space>
void check_sums(Space const& space) {
  crowded_scene<Space> scene(space);
  crowded_scene<collide::host> here(collide::host(1));
  collide::detector<collide::bucket> detector(collide::host(1));
  auto const contacts = detector.detect(here.mesh, here.spheres, collide::contacts<float>()).to_host();
  sums expected{};
  for (auto const& c : contacts) {
    expected.spheres += c.sphere;
    expected.depth += static_cast<std::int64_t>(double(c.depth) * 4294967296.0);
  }
  std::uint64_t const n = contacts.size();
  REQUIRE(n > 20000);
  sums const found = scene.end(add_up{scene.begin()});
  CHECK(found.hits == n);
  CHECK(found.spheres == expected.spheres);
  CHECK(found.below == -static_cast<std::int32_t>(n));
  CHECK(found.hits_64 == n);
  CHECK(found.old == n * (n - 1) / 2);
  CHECK(found.depth == expected.depth);
  CHECK(found.hits_float == static_cast<float>(n));
  CHECK(found.hits_double == static_cast<double>(n));
}

}  // namespace tests
