/// \file
/// Which spheres of a rank go to which others.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/contact.hpp>
#include <collide/detail/execution/host_array.hpp>
#include <collide/detail/execution/multiversion.hpp>
#include <collide/detail/geometry/sphere_pack.hpp>
#include <collide/detail/numeric/exact_number.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/detail/ranks/near_others.hpp>
#include <collide/detail/ranks/rank_map.hpp>
#include <collide/detail/sinks/output.hpp>
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

/// Kernel body of `for_each` over so many spheres at a time: puts out a pair of each other rank that a sphere goes to,
/// and the sphere.
template <class Spheres, int Items>
struct find_routes {
  using S = typename Spheres::scalar;
  Spheres spheres;
  rank_lookup map;
  near_others<S> quick;
  double extent;
  int self;
  output to;
  COLLIDE_HD void operator()(std::size_t pack) const {
    std::size_t const first = pack * Items;
    std::uint32_t near = 0;
    multiversioned([&] {
      sphere_batch<S, Items> batch;
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
      if (rank != self) to.store(to.allocate(1), pair{static_cast<id>(rank), static_cast<id>(i)});
    });
  }
};

/// One pass over the spheres, as a `pair_collector` sees a query. Its spheres are ranks, and its triangles spheres.
template <class Space, class Spheres>
struct route_query {
  static constexpr int items = Space::host_accessible ? 32 : 4;
  struct count {
    std::size_t n;
    std::size_t size() const { return n; }
  };
  Space& space;
  find_routes<Spheres, items> find;
  count spheres, mesh;

  void operator()(output const& to) const {
    auto body = find;
    body.to = to;
    space.for_each((mesh.n + items - 1) / items, body);
    space.for_each(1, finish_only<output>{to});
  }
};

/// Kernel body of `for_each` over numbers: how many of the pairs, which are in canonical order, are of lower spheres.
struct find_bounds {
  pair const* pairs;
  std::size_t size;
  std::uint64_t const* spheres;
  std::uint64_t* bounds;
  COLLIDE_HD void operator()(std::size_t i) const {
    std::size_t low = 0, high = size;
    while (low < high) {
      std::size_t const middle = (low + high) / 2;
      if (pairs[middle].sphere < spheres[i]) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    bounds[i] = low;
  }
};

/// Finds where in a canonical list of pairs, in memory of a space, those of some spheres begin.
class pair_bounds {
 public:
  /// Replaces each number by that of the pairs of lower spheres. Waits.
  template <class Space>
  void find(Space const& space, pair const* pairs, std::size_t size, std::vector<std::uint64_t>& numbers) {
    std::uint64_t* const bounds = bounds_.reserve(space.resource(), numbers.size());
    std::uint64_t const* const spheres = in_space(space, numbers, numbers_);
    space.for_each(numbers.size(), find_bounds{pairs, size, spheres, bounds});
    space.copy_to_host(numbers.data(), bounds, numbers.size());
  }

 private:
  buffer<std::uint64_t> numbers_, bounds_;
};

/// Routes: pairs of a rank and a sphere in canonical order, in memory of the space. 8 bytes for each, and in the
/// space of a device twice that for the sort.
class sphere_routes {
 public:
  /// Finds the routes of spheres to ranks other than `self`.
  template <class Space, class Spheres>
  void find(Space& space, rank_lookup const& map, Spheres const& spheres, int self, int ranks) {
    ends_.resize(static_cast<std::size_t>(ranks) + 1);
    for (std::size_t r = 0; r < ends_.size(); ++r) ends_[r] = r;
    double const extent = map.grid.meets(map.grid.frame()) ? map.grid.frame().max_extent() : 0;
    near_others<typename Spheres::scalar> const quick(map, extent, spheres.common_radius());
    route_query<Space, Spheres> const query{
        space, {spheres, map, quick, extent, self, {}}, {static_cast<std::size_t>(ranks)}, {spheres.size()}};
    list_.fill(space, query);
    list_.sort(space, query);
    bounds_.find(space, list_.data(), list_.size(), ends_);
  }

  /// How many there are.
  std::size_t size() const { return list_.size(); }

  /// Some routes, one after the other.
  struct part {
    pair const* first;
    std::size_t size;
  };
  /// What is sent to a rank in one of so many rounds: about the same number in each.
  part of(std::size_t rank, std::uint64_t round, std::uint64_t rounds) const {
    std::uint64_t const all = ends_[rank + 1] - ends_[rank];
    std::uint64_t const most = (all + rounds - 1) / rounds, begin = std::min(all, round * most);
    return {list_.data() + ends_[rank] + begin, static_cast<std::size_t>(std::min(all, begin + most) - begin)};
  }

 private:
  pair_collector list_;
  std::vector<std::uint64_t> ends_;  ///< where the routes of a rank begin, and all end
  pair_bounds bounds_;
};

}  // namespace collide::detail
