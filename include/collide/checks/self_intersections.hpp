/// \file
/// Finds where the triangles of a mesh cut through each other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <collide/broad/detail/tree/sah_tree.hpp>
#include <collide/broad/detail/tree/tree_ref.hpp>
#include <collide/checks/validate_closed.hpp>
#include <collide/exact/detail/predicates/exact_triangles.hpp>

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

/// Throws `error` of a function for a mesh that it cannot look through in pairs.
template <class S>
void check_for_pairs(mesh_view<S> const& mesh, std::string const& function) {
  check_memory<host>(mesh, (function + ": the mesh is").c_str(), "copy it to the host");
  if (mesh.size() >= std::size_t{1} << 29)
    throw error("collide: " + function + ": a mesh has fewer than 2^29 triangles");
  check_corners(mesh, function.c_str());
}

/// Calls f(i)(other, to) for all triangles i whose box, wider by `margin` on all sides, meets that of a triangle of a
/// larger number, and returns all that was added to the vectors `to`, sorted. Triangles that are not finite are left
/// out.
template <class Found, class S, class F>
std::vector<Found> found_in_pairs(mesh_view<S> const& mesh, S margin, host const& space, F const& f) {
  std::vector<Found> found;
  sah_tree<S> tree;
  buffer<tree_node> nodes;
  if (mesh.size() == 0 || !tree.build(space, mesh, nodes)) return found;
  tree_ref<S> const ref{mesh, nodes.data(), tree.before()};
  vec3<S> const wider(margin, margin, margin);
  constexpr std::size_t share = 256;
  std::vector<std::vector<Found>> parts((mesh.size() + share - 1) / share);
  for_each_block(space, parts.size(), [&](std::size_t p) {
    for (std::size_t i = share * p; i < std::min(mesh.size(), share * (p + 1)); ++i) {
      triangle<S> const t = mesh[i];
      if (!is_finite(t)) continue;
      auto const add = f(static_cast<id>(i));
      vec3<S> const lower = min(min(t.a, t.b), t.c) - wider, upper = max(max(t.a, t.b), t.c) + wider;
      ref.for_each_overlapping(tree_point(tree_box_of(triangle<S>{lower, upper, upper}, tree_origin(mesh))),
                               [&](id other) {
                                 if (other > i && is_finite(mesh[other])) add(other, parts[p]);
                                 return true;
                               });
    }
  });
  for (auto const& part : parts) found.insert(found.end(), part.begin(), part.end());
  std::sort(found.begin(), found.end());
  return found;
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
  detail::check_for_pairs(mesh, "self_intersections");
  auto const merged = detail::merged_vertices(mesh.vertices());
  return detail::found_in_pairs<triangle_pair>(mesh, S(0), space, [&](id i) {
    return [&, i, first = detail::seen_in(mesh, merged, i)](id other, std::vector<triangle_pair>& to) {
      if (!first.has_area()) return;
      detail::seen_triangle const second = detail::seen_in(mesh, merged, other);
      if (second.has_area() && detail::seen_triangle::meet(first, second)) to.push_back({i, other});
    };
  });
}

}  // namespace collide
