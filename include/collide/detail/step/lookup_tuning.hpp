/// \file
/// How a simulation uses a broad phase: it asks for the triangles near single spheres.
#pragma once

#include <type_traits>
#include <utility>

#include <collide/detail/execution/tuning.hpp>
#include <collide/mesh.hpp>
#include <collide/spheres.hpp>

namespace collide {

namespace detail {

/// A space as a broad phase sees it that is asked for the triangles near single spheres: they are sorted, not the
/// spheres, and into narrow cells, as a look-up is cheap and a candidate is not.
template <class Space>
struct lookup_tuning : Space {
  explicit lookup_tuning(Space const& space) : Space(space) {}
};

template <class Index, class = void>
struct has_lookup : std::false_type {};
template <class Index>
struct has_lookup<Index, std::void_t<decltype(std::declval<Index const&>().lookup())>> : std::true_type {};

/// Makes what look-ups need of a mesh, and of the particles' radii. Not inline; see compiled.hpp.
template <class Index, class Space, class Options, class S>
void build_lookup(Index& index, lookup_tuning<Space>& space, Options const& options, mesh_view<S> const& mesh) {
  index.build(space, options, mesh);
}
template <class Index, class Space, class Options, class S>
void prepare_lookup(Index& index, lookup_tuning<Space>& space, Options const& options, sphere_view<S> const& spheres) {
  index.prepare(space, options, spheres);
}

}  // namespace detail

template <class Space>
struct bucket_tuning<detail::lookup_tuning<Space>> : bucket_tuning<Space> {
  static constexpr bool bins_spheres = false;
  /// The grid serves many steps. On a device narrower cells gain nothing: their bits take more memory.
  static constexpr bucket_costs costs{bucket_tuning<Space>::costs.entry_ns / (Space::host_accessible ? 16 : 1),
                                      bucket_tuning<Space>::costs.candidate_ns, bucket_tuning<Space>::costs.level_ns,
                                      bucket_tuning<Space>::costs.step_ns};
};

}  // namespace collide
