/// \file
/// Finds where the triangles of a mesh cut through each other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/detail/predicates/exact_triangles.hpp>
#include <collide/detail/tree/sah_tree.hpp>
#include <collide/detail/tree/tree_ref.hpp>
#include <collide/validate_closed.hpp>

namespace collide {

/// Two triangles.
struct triangle_pair {
  id first;   ///< the smaller number
  id second;  ///< the larger number

  /// True of the same two.
  friend bool operator==(triangle_pair const& p, triangle_pair const& q) {
    return p.first == q.first && p.second == q.second;
  }
  /// By the first, then by the second.
  friend bool operator<(triangle_pair const& p, triangle_pair const& q) {
    return p.first != q.first ? p.first < q.first : p.second < q.second;
  }
};

namespace detail {

/// The triangle, with corners of equal coordinates as one vertex.
template <class S>
seen_triangle seen_in(mesh_view<S> const& mesh, std::vector<std::uint32_t> const& merged, std::size_t i) {
  return {widened(mesh[i]), {merged[mesh.corner(i, 0)], merged[mesh.corner(i, 1)], merged[mesh.corner(i, 2)]}};
}

/// Adds the triangles behind number `i` that meet it.
template <class S>
void add_met_by(tree_ref<S> const& tree, std::vector<std::uint32_t> const& merged, std::size_t i,
                std::vector<triangle_pair>& to) {
  triangle<S> const t = tree.mesh[i];
  if (!is_finite(t)) return;
  seen_triangle const shape = seen_in(tree.mesh, merged, i);
  if (!shape.has_area()) return;
  tree.for_each_overlapping(tree_point(tree_box_of(t, tree_origin(tree.mesh))), [&](id other) {
    if (other <= i) return true;
    seen_triangle const second = seen_in(tree.mesh, merged, other);
    if (second.has_area() && seen_triangle::meet(shape, second)) to.push_back({static_cast<id>(i), other});
    return true;
  });
}

}  // namespace detail

/// The pairs of triangles that have a point in common which is not of a corner or an edge that they share: those that
/// cut through each other or touch, be it in a point, those that overlap in a plane, and those with the same three
/// corners. Exact, for all finite coordinates. Corners with equal coordinates are one, as in `validate_closed`.
/// Triangles that are not finite, or whose corners lie on a line, are not there. Where a closed mesh cuts itself,
/// `contains` takes what is inside twice for outside.
///
/// \param mesh  in memory that the host can read, fewer than 2^29 triangles
/// \param space  its threads work
/// \return the pairs, sorted
/// \throws error  if a triangle names a vertex that does not exist, CUDA knows that the mesh is in device memory, or
///                there are too many triangles
/// \complexity O(n log n + k) for n triangles and vertices, where the boxes of k pairs meet. Allocates as a detector
///             with `bvh`, and 32 bytes for each vertex.
template <class S>
std::vector<triangle_pair> self_intersections(mesh_view<S> const& mesh, host const& space = host()) {
  detail::check_memory<host>(mesh, "self_intersections: the mesh is", "copy it to the host");
  if (mesh.size() >= std::size_t{1} << 29)
    throw error("collide: self_intersections: a mesh has fewer than 2^29 triangles");
  detail::check_corners(mesh, "self_intersections");
  std::vector<triangle_pair> found;
  detail::sah_tree<S> tree;
  buffer<detail::tree_node> nodes;
  if (mesh.size() == 0 || !tree.build(space, mesh, nodes)) return found;
  auto const merged = detail::merged_vertices(mesh.vertices());
  detail::tree_ref<S> const ref{mesh, nodes.data(), tree.before()};
  constexpr std::size_t share = 256;
  std::vector<std::vector<triangle_pair>> parts((mesh.size() + share - 1) / share);
  detail::for_each_block(space, parts.size(), [&](std::size_t p) {
    for (std::size_t i = share * p; i < std::min(mesh.size(), share * (p + 1)); ++i)
      detail::add_met_by(ref, merged, i, parts[p]);
  });
  for (auto const& part : parts) found.insert(found.end(), part.begin(), part.end());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace collide
