/// \file
/// A mesh that was read from a file, in host memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <collide/mesh.hpp>

namespace collide {

/// The triangles of a file, in its order.
template <class S>
struct mesh_data {
  std::vector<S> vertices;             ///< x0, y0, z0, x1, ..., in the units of the file
  std::vector<std::uint32_t> corners;  ///< three vertex numbers a triangle, from 0

  /// Number of triangles.
  std::size_t size() const { return corners.size() / 3; }
  /// A view for `detector::build` on the host and for `upload`; good as long as the data is. O(1).
  mesh_view<S> view() const { return indexed_mesh(vertices.data(), vertices.size() / 3, corners.data(), size()); }
};

namespace detail {

/// Throws unless all is there that a mesh of this file needs.
template <class S>
mesh_data<S> checked_mesh(mesh_data<S> mesh, std::string const& what) {
  for (std::uint32_t const c : mesh.corners) {
    if (c >= mesh.vertices.size() / 3)
      throw error(what + ": vertex " + std::to_string(std::uint64_t{c} + 1) + " does not exist");
  }
  for (S const x : mesh.vertices) {
    if (!(x - x == 0)) throw error(what + ": a coordinate is not finite");
  }
  if (mesh.size() == 0) throw error(what + ": there are no triangles");
  return mesh;
}

}  // namespace detail
}  // namespace collide
