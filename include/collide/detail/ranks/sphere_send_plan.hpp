/// \file
/// Which spheres of a rank go to which others.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/detail/execution/multiversion.hpp>
#include <collide/detail/geometry/sphere_pack.hpp>
#include <collide/detail/numeric/exact_number.hpp>
#include <collide/detail/ranks/halo_filter.hpp>
#include <collide/detail/ranks/rank_map.hpp>
#include <collide/detail/ranks/send_plan.hpp>
#include <collide/moving_spheres.hpp>

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

/// Kernel functor of `for_each` over so many spheres at a time: lists those that may go to other ranks.
template <class Spheres, int Items>
struct find_near {
  using S = typename Spheres::scalar;
  Spheres spheres;
  halo_filter<S> quick;
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
      if (i < spheres.size()) add_send(to, 0, i);
    }
  }
};

/// Kernel functor of `for_each` over these: puts out a pair of each other rank that a sphere goes to, and the sphere.
template <class Spheres>
struct find_sends {
  Spheres spheres;
  pair const* near;
  rank_lookup map;
  double extent;
  int self;
  output to;
  COLLIDE_HD void operator()(std::size_t k) const {
    id const i = near[k].triangle;
    map.for_each_rank(reach_of(spheres, i, extent), [&](int rank) {
      if (rank != self) add_send(to, rank, i);
    });
  }
};

/// Routes of a rank's spheres. With two ranks there is nothing to sort.
class sphere_send_plan : public send_plan {
 public:
  /// Finds the routes of spheres to ranks other than `self`: of the few that pass the quick test, in a kernel of their
  /// own, as threads of a GPU wait for each other.
  template <class Space, class Spheres>
  void find(Space& space, rank_lookup const& map, Spheres const& spheres, int self, int ranks) {
    constexpr int items = Space::host_accessible ? 32 : 4;
    double const extent = map.grid.meets(map.grid.frame()) ? map.grid.frame().max_extent() : 0;
    halo_filter<typename Spheres::scalar> const quick(map, extent, spheres.common_radius());
    using near_query = send_query<Space, find_near<Spheres, items>>;
    near_.fill(space, near_query{space, {spheres, quick, {}}, (spheres.size() + items - 1) / items, {1}, {0}});
    send_plan::find(space, find_sends<Spheres>{spheres, near_.data(), map, extent, self, {}}, near_.size(),
                    spheres.size(), ranks, ranks == 2 ? 1 - self : -1);
  }

 private:
  pair_collector near_;
};

}  // namespace collide::detail
