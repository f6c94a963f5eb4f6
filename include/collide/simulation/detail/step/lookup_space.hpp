/// \file
/// How a simulation uses a broad phase: it asks for the triangles near single spheres.
#pragma once

#include <collide/spaces/detail/tuning.hpp>

namespace collide {

namespace detail {

/// A space as a broad phase sees it that is asked for the triangles near single spheres: they are sorted, not the
/// spheres, and into narrow cells, as a look-up is cheap and a candidate is not.
template <class Space>
struct lookup_space : Space {};

template <class Space>
inline constexpr bool serves_steps<lookup_space<Space>> = true;

}  // namespace detail

template <class Space>
struct bucket_tuning<detail::lookup_space<Space>> : bucket_tuning<Space> {
  static constexpr bool bins_spheres = false;
  /// The grid serves many steps. On a device narrower cells gain nothing: their bits take more memory.
  static constexpr bucket_costs costs{bucket_tuning<Space>::costs.entry_ns / (Space::host_accessible ? 16 : 1),
                                      bucket_tuning<Space>::costs.candidate_ns,
                                      bucket_tuning<Space>::costs.level_ns,
                                      bucket_tuning<Space>::costs.step_ns,
                                      bucket_tuning<Space>::costs.serial_ns,
                                      0,
                                      0,
                                      0};
};

template <class Space>
struct bvh_tuning<detail::lookup_space<Space>> : bvh_tuning<Space> {};

}  // namespace collide
