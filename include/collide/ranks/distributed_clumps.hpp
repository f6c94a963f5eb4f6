/// \file
/// Puts clumps into a simulation on many ranks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/ranks/distributed_simulation.cuh>
#include <collide/ranks/ranks.hpp>
#include <collide/simulation/place_clumps.hpp>

namespace collide {

/// Puts clumps of this rank, perhaps none, into a simulation on ranks, as `set_clumps` of place_clumps.hpp: one after
/// the other, those of the ranks are those of one. `waiting` is the same number on each; those that wait are the last
/// rank's. All ranks call it. A clump is on the rank in whose subdomain its centre of mass is, with all of its spheres.
template <class Detector, class... Effect, class Ranks>
void set_clumps(distributed<simulation<Detector, Effect...>, Ranks>& to, std::vector<clump_shape> const& shapes,
                std::vector<placed_clump> const& mine, std::size_t waiting = 0) {
  using columns_type = detail::columns_of_clumps<typename Detector::scalar>;
  Ranks const& ranks = to.ranks();
  columns_type all;
  typename columns_type::spheres_in_space spheres;
  together(ranks, [&] {
    bool const is_last = ranks.rank() + 1 == ranks.size();
    detail::check_parameter(!is_last || waiting <= mine.size(), "set_clumps: all clumps that wait are the last rank's");
    all.add(shapes, mine, is_last ? waiting : 0);
    spheres = all.spheres_in(to.space());
  });
  all.number_from(count_before(ranks, all.size()));
  std::uint64_t const there = all.there, reach = detail::to_ordered_bits(all.reach);
  std::uint64_t placed = 0, farthest = 0;
  ranks.reduce(&there, &placed, 1, reduction::sum);
  ranks.reduce(&reach, &farthest, 1, reduction::max);
  all.reach = detail::from_ordered_bits<double>(farthest);
  to.set(spheres.view, spheres.velocities.data(), 0, [&](auto& part) {
    all.assign_to(part);
    part.internals().particles.all_placed = static_cast<std::size_t>(placed);
  });
}

}  // namespace collide
