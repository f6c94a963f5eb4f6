/// \file
/// Sink: which points are inside a closed mesh.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/narrow/detail/ray_parity.hpp>
#include <collide/sinks/detail/array_in_space.hpp>
#include <collide/sinks/detail/search_mesh.hpp>

namespace collide {

namespace detail {

/// The parity that tells if a point is inside the mesh. `Search` is a `mesh_search`.
template <class S, class Search>
COLLIDE_HD ray_parity<S> parity_of(vec3<S> const& point, mesh_view<S> const& mesh, Search const& search) {
  ray_parity<S> parity(point);
  search.on_ray([&](id t) { return parity.consider(mesh[t]); });
  return parity;
}

/// Search functor of `contains` for each point.
struct find_inside {
  std::uint8_t* to;

  template <class S, class Search>
  COLLIDE_HD void operator()(std::size_t i, sphere<S> const& s, mesh_view<S> const& mesh, Search const& search) const {
    to[i] = parity_of(s.centre, mesh, search).inside() ? 1 : 0;
  }
};

}  // namespace detail

/// A flag per point: 1 if it is inside the mesh or on its surface, else 0. Of spheres it is that of the centre. A point
/// that is not finite is outside.
///
/// It is inside if a ray from it crosses the mesh an odd number of times: exactly, whatever the precision of the narrow
/// phase, and with no special case for rays through edges and corners. Of a closed mesh that is the inside, however its
/// triangles are oriented, and triangle soups are meshes whose corners are one where their coordinates are equal. Where
/// a mesh is not closed the result depends on which way the ray goes, along +z: see `validate_closed`, and
/// `winding_number`.
///
/// Needs a broad phase that finds what is above a point: `bvh`, or `all_pairs`. O(triangles above or below the point)
/// with `bvh`, and more where these are near each other. `query` does not wait for the flags. Memory: one byte per
/// point.
class contains : public detail::array_per_sphere<std::uint8_t> {
 public:
  /// The flags are kept in memory of the space.
  contains() = default;
  /// The flags are written to the caller's memory (of the space), one byte per point: 0 or 1, for all points of the
  /// query. It must have room for them, and stay valid as long as this object is used.
  explicit contains(std::uint8_t* flags) : array_per_sphere{flags} {}

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    detail::search_mesh(query, detail::find_inside{room_for(space, query.spheres.size())});
  }
};

}  // namespace collide
