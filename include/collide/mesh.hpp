/// \file
/// Views of a triangle mesh in the caller's memory: indexed, or a triangle soup.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>

#include <collide/error.hpp>
#include <collide/geometry.hpp>

namespace collide {

/// A non-owning view of a mesh: host memory for `host`, device memory for the CUDA spaces. Nothing is copied or checked
/// (`validate` does that); an index that is not below the number of vertices is undefined behaviour. The memory must
/// outlive every detector that was built from the view. Made by `indexed_mesh` and `triangle_soup`.
template <class S>
class mesh_view {
  static_assert(std::is_same<S, float>::value || std::is_same<S, double>::value,
                "collide: a mesh has coordinates of type float or double");

 public:
  using scalar = S;

  mesh_view() = default;
  COLLIDE_HD mesh_view(S const* vertices, std::size_t vertex_count, id const* indices, std::size_t size)
      : vertices_{vertices}, indices_{indices}, vertex_count_{vertex_count}, size_{size} {}

  /// Number of triangles.
  COLLIDE_HD std::size_t size() const { return size_; }

  /// Triangle `i`, read from memory.
  COLLIDE_HD_INLINE triangle<S> operator[](std::size_t i) const {
    std::size_t a = 3 * i, b = a + 1, c = a + 2;
    if (indices_ != nullptr) {
      id const* const indices = indices_ + 3 * i;
      a = indices[0], b = indices[1], c = indices[2];
    }
    return {vertex(a), vertex(b), vertex(c)};
  }

  /// Vertex `i`, read from memory.
  COLLIDE_HD_INLINE vec3<S> vertex(std::size_t i) const {
    S const* const from = vertices_ + 3 * i;
    return {from[0], from[1], from[2]};
  }

  /// The coordinates, three per vertex.
  COLLIDE_HD S const* vertices() const { return vertices_; }
  /// Number of vertices.
  COLLIDE_HD std::size_t vertex_count() const { return vertex_count_; }
  /// The index array, three vertex numbers per triangle; null for a triangle soup.
  COLLIDE_HD id const* indices() const { return indices_; }

 private:
  S const* vertices_ = nullptr;
  id const* indices_ = nullptr;
  std::size_t vertex_count_ = 0;
  std::size_t size_ = 0;
};

/// View of an indexed mesh: `vertices` holds 3 * `vertex_count` coordinates, `indices` 3 * `triangle_count` vertex
/// numbers from 0, of any 32-bit integer type. O(1). Throws `error` if there are more than 2^32 - 2 triangles, or
/// triangles but no index array.
template <class S, class Index>
mesh_view<S> indexed_mesh(S const* vertices, std::size_t vertex_count, Index const* indices,
                          std::size_t triangle_count) {
  static_assert(std::is_integral<Index>::value && sizeof(Index) == sizeof(id),
                "collide: the indices of an indexed mesh are 32-bit integers");
  if (triangle_count >= no_id) throw error("collide: a mesh has at most 2^32 - 2 triangles");
  if (indices == nullptr && triangle_count != 0)
    throw error("collide: indexed_mesh: there are triangles but no indices");
  return {vertices, vertex_count, reinterpret_cast<id const*>(indices), triangle_count};
}

/// View of a triangle soup: 9 coordinates per triangle, vertex by vertex. O(1). Throws `error` if there are more than
/// 2^32 - 2 triangles.
template <class S>
mesh_view<S> triangle_soup(S const* coordinates, std::size_t triangle_count) {
  if (triangle_count >= no_id) throw error("collide: a mesh has at most 2^32 - 2 triangles");
  return {coordinates, 3 * triangle_count, nullptr, triangle_count};
}

}  // namespace collide
