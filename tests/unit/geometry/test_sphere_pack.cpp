/// Packs of spheres, against the views that they are loaded from.
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include <collide/core/points.hpp>
#include <collide/exact/detail/geometry/sphere_pack.hpp>

using namespace collide::detail;

namespace {

constexpr std::size_t n = 11;  // two packs of four and a part of one

/// Numbers that are all different, in every layout.
template <class S>
struct scene {
  std::vector<S> xyz, x, y, z, radii, displacements;

  scene() {
    for (std::size_t i = 0; i < n; ++i) {
      auto const v = static_cast<S>(i);
      x.push_back(v), y.push_back(100 + v), z.push_back(200 + v), radii.push_back(1 + v);
      xyz.insert(xyz.end(), {x[i], y[i], z[i]});
      displacements.insert(displacements.end(), {300 + v, 400 + v, 500 + v});
    }
  }
};

template <class S>
void check_still(collide::sphere_view<S> const& spheres) {
  sphere_pack<S, 4> batch;
  for (std::size_t first = 0; first < n + 4; first += 4) {
    batch.load(spheres, first);
    for (int k = 0; k < 4; ++k) {
      std::size_t const i = first + static_cast<std::size_t>(k);
      if (i < n) {
        CHECK(batch.shape(k).centre == spheres.centre(i));
        CHECK(batch.shape(k).radius == spheres.radius(i));
      } else {
        CHECK(std::isnan(batch.radius[k]));
        CHECK(batch.x[k] > 1e30);
      }
    }
  }
}

template <class S>
void check_moving(collide::moving_sphere_view<S> const& spheres) {
  moving_pack<S, 4> batch;
  sphere_pack<S, 4> around;
  for (std::size_t first = 0; first < n + 4; first += 4) {
    batch.load(spheres, first);
    around.load(spheres, first);
    for (int k = 0; k < 4; ++k) {
      std::size_t const i = first + static_cast<std::size_t>(k);
      if (i < n) {
        CHECK(batch.shape(k).centre == spheres[i].centre);
        CHECK(batch.shape(k).radius == spheres[i].radius);
        CHECK(batch.shape(k).displacement == spheres[i].displacement);
        CHECK(around.shape(k).centre == swept_bounding_sphere(spheres[i]).centre);
        CHECK(around.shape(k).radius == swept_bounding_sphere(spheres[i]).radius);
      } else {
        CHECK(std::isnan(batch.radius[k]));
        CHECK(std::isnan(around.radius[k]));
      }
    }
  }
}

}  // namespace

TEST_CASE_TEMPLATE("sphere pack: every layout, one radius or one each, and beyond the end", S, float, double) {
  scene<S> const made;
  auto const packed_one = collide::spheres_xyz(made.xyz.data(), n, S(0.5));
  auto const packed = collide::spheres_xyz(made.xyz.data(), n, made.radii.data());
  auto const apart =
      collide::spheres_at(collide::points(made.x.data(), made.y.data(), made.z.data(), n), made.radii.data());
  for (auto const& spheres : {packed_one, packed, apart}) {
    check_still<S>(spheres);
    check_moving<S>(collide::with_displacements(spheres, made.displacements.data()));
  }
}
