/// \file
/// A mesh that was read from a file, in host memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include <collide/exact/detail/numeric/rounding.hpp>
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

/// Cuts a polygon of `n` corners into n - 2 triangles around one of its corners, and adds them to `mesh`. False if
/// there is no corner from which all of it is seen, or none among the first of a polygon of very many.
template <class S>
bool add_fan(mesh_data<S>& mesh, std::uint32_t const* polygon, std::size_t n) {
  auto const at = [&](std::size_t i) -> vec3<double> {
    S const* const p = &mesh.vertices[3 * std::size_t{polygon[i % n]}];
    return vec3<S>(p[0], p[1], p[2]).template cast<double>();
  };
  auto const normal = [&](std::size_t a, std::size_t b, std::size_t c) -> vec3<double> {
    return cross(vec3<double>(at(b) - at(a)), vec3<double>(at(c) - at(a)));
  };
  vec3<double> whole(0, 0, 0);
  for (std::size_t i = 1; i + 1 < n; ++i) whole += normal(0, i, i + 1);
  for (std::size_t first = 0; first < std::min<std::size_t>(n, 1000); ++first) {
    bool sees_all = true;
    for (std::size_t i = 1; i + 1 < n && sees_all; ++i) {
      sees_all = n == 3 || dot(normal(first, first + i, first + i + 1), whole) >= 0;
    }
    if (!sees_all) continue;
    for (std::size_t i = 1; i + 1 < n; ++i) {
      for (std::size_t const k : {first, first + i, first + i + 1}) mesh.corners.push_back(polygon[k % n]);
    }
    return true;
  }
  return false;
}

/// Adds the triangles of a face, whose corners are numbers of vertices of `mesh` as the file has them, but from 0.
/// \param base  what the first vertex is called
/// \param fail  throws what it is told is wrong
template <class S, class Fail>
void add_face(mesh_data<S>& mesh, std::vector<std::int64_t> const& corners, int base, Fail const& fail) {
  std::vector<std::uint32_t> polygon;
  auto const vertices = static_cast<std::int64_t>(mesh.vertices.size() / 3);
  for (std::int64_t const c : corners) {
    if (c < 0 || c >= vertices || c > INT64_C(0xffffffff)) {
      fail("vertex " + std::to_string(c + base) + " does not exist: there are " + std::to_string(vertices));
    }
    polygon.push_back(static_cast<std::uint32_t>(c));
  }
  if (polygon.size() < 3) fail("a face of fewer than three corners");
  if (!add_fan(mesh, polygon.data(), polygon.size()))
    fail("a face of " + std::to_string(polygon.size()) + " corners is too concave: triangulate the mesh");
}

/// A mesh whose vertices of equal coordinates, which are finite, are one: the first of them.
template <class S>
mesh_data<S> welded(mesh_data<S> mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size() / 3), number(order.size());
  auto const at = [&](std::uint32_t i) {
    S const* const p = &mesh.vertices[3 * std::size_t{i}];
    return std::make_tuple(p[0], p[1], p[2]);
  };
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return at(a) != at(b) ? at(a) < at(b) : a < b; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    bool const again = k > 0 && at(order[k]) == at(order[k - 1]);
    number[order[k]] = again ? number[order[k - 1]] : order[k];
  }
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < number.size(); ++i) {
    bool const first = number[i] == i;
    if (first) std::copy_n(&mesh.vertices[3 * std::size_t{i}], 3, &mesh.vertices[3 * std::size_t{kept}]);
    number[i] = first ? kept++ : number[number[i]];
  }
  mesh.vertices.resize(3 * std::size_t{kept});
  for (auto& c : mesh.corners) c = number[c];
  return mesh;
}

}  // namespace detail
}  // namespace collide
