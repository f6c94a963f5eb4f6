/// \file
/// A mesh from a Wavefront OBJ file, by tinyobjloader (Debian: libtinyobjloader-dev). One source file of a program
/// defines TINYOBJLOADER_IMPLEMENTATION before it includes this.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <tiny_obj_loader.h>

#include <collide/detail/numeric/rounding.hpp>
#include <collide/io/mesh_data.hpp>

namespace collide {
namespace detail {

/// Cuts a polygon of `n` corners into n - 2 triangles around one of its corners, and adds them to `mesh`. False if
/// there is no corner from which all of it is seen.
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
  for (std::size_t first = 0; first < n; ++first) {
    bool sees_all = true;
    for (std::size_t i = 1; i + 1 < n; ++i) {
      sees_all = sees_all && dot(normal(first, first + i, first + i + 1), whole) >= 0;
    }
    if (!sees_all) continue;
    for (std::size_t i = 1; i + 1 < n; ++i) {
      for (std::size_t const k : {first, first + i, first + i + 1}) mesh.corners.push_back(polygon[k % n]);
    }
    return true;
  }
  return false;
}

}  // namespace detail

/// Reads the triangles of all faces of an OBJ file, in its order, whatever objects and groups they are in. Lines and
/// points are left out; a polygon is cut into triangles around one of its corners. Numbers are as tinyobjloader reads
/// them: for doubles, TINYOBJLOADER_USE_DOUBLE must be defined wherever it is included. O(size of the file).
///
/// \throws error  names the file: if it cannot be read, has no triangle, a vertex number that does not exist, a
///                coordinate that is not finite, or a polygon that cannot be seen from one of its corners
template <class S = float>
mesh_data<S> read_obj(std::string const& path) {
  static_assert(std::is_same<S, float>::value || std::is_same<S, tinyobj::real_t>::value,
                "collide: read_obj<double> needs TINYOBJLOADER_USE_DOUBLE, defined wherever tiny_obj_loader.h is "
                "included");
  std::string const what = "collide: read_obj: " + path;
  tinyobj::ObjReaderConfig config;
  config.triangulate = false;
  tinyobj::ObjReader reader;
  if (!reader.ParseFromFile(path, config)) throw error(what + ": " + reader.Error());
  mesh_data<S> mesh;
  mesh.vertices.assign(reader.GetAttrib().vertices.begin(), reader.GetAttrib().vertices.end());
  std::vector<std::uint32_t> polygon;
  for (auto const& shape : reader.GetShapes()) {
    std::size_t next = 0;
    for (std::size_t const n : shape.mesh.num_face_vertices) {
      polygon.clear();
      for (std::size_t k = 0; k < n; ++k) {
        polygon.push_back(static_cast<std::uint32_t>(shape.mesh.indices[next++].vertex_index));
        if (polygon.back() >= mesh.vertices.size() / 3) throw error(what + ": a vertex does not exist");
      }
      if (n >= 3 && !detail::add_fan(mesh, polygon.data(), n))
        throw error(what + ": a face of " + std::to_string(n) + " corners is too concave: triangulate the mesh");
    }
    if (next != shape.mesh.indices.size()) throw error(what + ": a face has more corners than tinyobjloader counts");
  }
  return detail::checked_mesh(std::move(mesh), what);
}

}  // namespace collide
