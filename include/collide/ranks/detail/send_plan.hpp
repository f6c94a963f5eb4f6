/// \file
/// Which things of a rank go to which other ranks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/core/contact.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/sinks/detail/output.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide::detail {

/// One pass over the items of a rank, as a `pair_collector` sees a query: in place of spheres it has ranks, in place of
/// triangles items.
template <class Space, class Find>
struct send_query {
  struct count {
    std::size_t n;
    std::size_t size() const { return n; }
  };
  Space& space;
  Find find;
  std::size_t calls;
  count spheres, mesh;

  void operator()(output const& to) const {
    Find kernel = find;
    kernel.to = to;
    space.for_each(calls, kernel);
    space.for_each(1, end_pass_kernel<output>{to});
  }
};

/// Kernel functor of `for_each` over numbers: how many of the pairs, which are in canonical order, are of lower
/// spheres.
struct find_bounds {
  pair const* pairs;
  std::size_t size;
  std::uint64_t const* spheres;
  std::uint64_t* bounds;
  COLLIDE_HD void operator()(std::size_t i) const {
    bounds[i] = first_not_before(std::size_t{0}, size, [&](std::size_t k) { return pairs[k].sphere < spheres[i]; });
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

/// A route is kept as a pair, so that it can be collected and sorted like one: a rank, and an item that goes there.
COLLIDE_HD_INLINE pair route_of(int rank, std::size_t item) { return {static_cast<id>(rank), static_cast<id>(item)}; }
COLLIDE_HD_INLINE int rank_of(pair const& route) { return static_cast<int>(route.sphere); }
COLLIDE_HD_INLINE id item_of(pair const& route) { return route.triangle; }

/// Routes, in canonical order, in memory of a space. 8 bytes
/// for each, and in the space of a device twice that for the sort.
class send_plan {
 public:
  /// Finds the routes of so many items. `find` is a kernel functor of `for_each`, which is called `calls` times:
  /// `add_send(to, rank, item)`, with its member `to`, lists a route.
  template <class Space, class Find>
  void find(Space& space, Find const& find, std::size_t calls, std::size_t items, int ranks) {
    ends_.resize(static_cast<std::size_t>(ranks) + 1);
    for (std::size_t r = 0; r < ends_.size(); ++r) ends_[r] = r;
    send_query<Space, Find> const query{space, find, calls, {static_cast<std::size_t>(ranks)}, {items}};
    list_.fill(space, query);
    list_.sort(space, query);
    bounds_.find(space, list_.data(), list_.size(), ends_);
  }

  std::size_t size() const { return list_.size(); }
  pair const* data() const { return list_.data(); }
  std::uint64_t count(std::size_t rank) const { return ends_[rank + 1] - ends_[rank]; }
  std::vector<std::uint64_t> counts() const {
    std::vector<std::uint64_t> all;
    for (std::size_t r = 0; r + 1 < ends_.size(); ++r) all.push_back(count(r));
    return all;
  }

  /// Some routes, one after the other.
  struct part {
    pair const* first;
    std::size_t size;
  };
  /// The items that are sent to a rank in one of so many rounds: about the same number in each.
  part of(std::size_t rank, std::uint64_t round, std::uint64_t rounds) const {
    std::uint64_t const all = count(rank), share = (all + rounds - 1) / rounds, begin = std::min(all, round * share);
    return {list_.data() + ends_[rank] + begin, static_cast<std::size_t>(std::min(all, begin + share) - begin)};
  }

 private:
  pair_collector list_;
  std::vector<std::uint64_t> ends_;  ///< where the routes of a rank begin, and all end
  pair_bounds bounds_;
};

COLLIDE_HD_INLINE void add_send(output const& to, int rank, std::size_t item) {
  to.store(to.allocate(1), route_of(rank, item));
}

}  // namespace collide::detail
