/// \file
/// Which spheres of a rank go to which others.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/core/moving_spheres.hpp>
#include <collide/exact/detail/geometry/sphere_pack.hpp>
#include <collide/exact/detail/numeric/exact_number.hpp>
#include <collide/ranks/detail/halo_filter.hpp>
#include <collide/ranks/detail/rank_map.hpp>
#include <collide/ranks/detail/send_plan.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// `reach_of` sphere i of a view of spheres, at rest or moving.
template <class S>
COLLIDE_HD aabb<double> reach_of(sphere_view<S> const& spheres, std::size_t i, double extent) {
  return reach_of(spheres[i], vec3<S>(0, 0, 0), extent);
}
template <class S>
COLLIDE_HD aabb<double> reach_of(moving_sphere_view<S> const& spheres, std::size_t i, double extent) {
  auto const s = spheres[i];
  return reach_of(sphere<S>{s.centre, s.radius}, s.displacement, extent);
}

/// Kernel functor of `for_each` over so many spheres at a time: puts out a pair of each other rank that a sphere goes
/// to, and the sphere.
template <class Spheres, int Items>
struct find_sends {
  using S = typename Spheres::scalar;
  Spheres spheres;
  rank_lookup map;
  halo_filter<S> quick;
  double extent;
  int self;
  output to;
  COLLIDE_HD void operator()(std::size_t pack) const {
    std::size_t const first = pack * Items;
    std::uint32_t near = 0;
    multiversioned([&] {
      sphere_pack<S, Items> batch;
      batch.load(spheres, first);
      near = quick.mark(batch);
    });
    for (; near != 0; near &= near - 1) {
      std::size_t const i = first + static_cast<std::size_t>(trailing_zeros(near));
      if (i < spheres.size()) find(i);
    }
  }

 private:
  COLLIDE_HD void find(std::size_t i) const {
    map.for_each_rank(reach_of(spheres, i, extent), [&](int rank) {
      if (rank != self) add_send(to, rank, i);
    });
  }
};

/// Routes of a rank's spheres.
class sphere_send_plan : public send_plan {
 public:
  /// Finds the routes of spheres to ranks other than `self`.
  template <class Space, class Spheres>
  void find(Space& space, rank_lookup const& map, Spheres const& spheres, int self, int ranks) {
    constexpr int items = Space::host_accessible ? 32 : 4;
    double const extent = map.grid.meets(map.grid.frame()) ? map.grid.frame().max_extent() : 0;
    halo_filter<typename Spheres::scalar> const quick(map, extent, spheres.common_radius());
    send_plan::find(space, find_sends<Spheres, items>{spheres, map, quick, extent, self, {}},
                    (spheres.size() + items - 1) / items, spheres.size(), ranks);
  }
};

}  // namespace collide::detail
