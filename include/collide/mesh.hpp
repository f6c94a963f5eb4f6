/// \file
/// Views of a triangle mesh in the caller's memory: indexed, or a triangle soup; in any layout of points.hpp.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include <collide/core/error.hpp>
#include <collide/core/points.hpp>

namespace collide {

/// A non-owning view of a mesh: host memory for `host`, device memory for the CUDA spaces. Nothing is copied or checked
/// (`validate` does that); an index that is not below the number of vertices is undefined behaviour. The memory must
/// outlive every detector that was built from the view. A triangle has two sides, and the order of its corners does not
/// matter. Made by `indexed_mesh` and `triangle_soup`. Members that read memory are for code that runs where it is.
template <class S>
class mesh_view {
  static_assert(std::is_same<S, float>::value || std::is_same<S, double>::value,
                "collide: a mesh has coordinates of type float or double");

 public:
  using scalar = S;  ///< type of the coordinates: float or double

  /// No triangles.
  mesh_view() = default;
  /// `size` triangles. The number of corner k of triangle i is at indices[i * triangle_stride + k * corner_stride], or
  /// 3 i + k if `indices` is null. Throws `error` if there are more than 2^32 - 2 triangles, a stride is negative or
  /// 2^32 or more, or there are vertices whose address is null.
  mesh_view(point_view<S> const& vertices, id const* indices, std::size_t size, std::size_t triangle_stride = 3,
            std::size_t corner_stride = 1)
      : vertices_{vertices},
        indices_{indices},
        size_{size},
        triangle_stride_{detail::checked_stride(triangle_stride)},
        corner_stride_{detail::checked_stride(corner_stride)} {
    if (size >= no_id) throw error("collide: a mesh has at most 2^32 - 2 triangles");
    vertices.check_addresses("vertices");
  }

  /// Number of triangles.
  COLLIDE_HD std::size_t size() const { return size_; }

  /// Triangle `i`, read from memory.
  COLLIDE_HD_INLINE triangle<S> operator[](std::size_t i) const {
    return {vertices_[corner(i, 0)], vertices_[corner(i, 1)], vertices_[corner(i, 2)]};
  }

  /// Number of the vertex that is corner `k` = 0, 1, 2 of triangle `i`, read from memory.
  COLLIDE_HD_INLINE std::size_t corner(std::size_t i, unsigned k) const {
    return indices_ == nullptr ? 3 * i + k : indices_[i * triangle_stride_ + std::size_t{corner_stride_} * k];
  }

  /// View of the `n` triangles from number `first` on. An indexed mesh keeps all its vertices, a soup those of the
  /// range. O(1); the range must exist.
  mesh_view subview(std::size_t first, std::size_t n) const {
    if (indices_ == nullptr) return {vertices_.subview(3 * first, 3 * n), nullptr, n};
    return {vertices_, indices_ + first * triangle_stride_, n, triangle_stride_, corner_stride_};
  }

  /// The vertices; of a triangle soup the corners, three per triangle.
  COLLIDE_HD point_view<S> const& vertices() const { return vertices_; }
  /// The vertex numbers of the corners; null for a triangle soup.
  COLLIDE_HD id const* indices() const { return indices_; }
  /// True if the vertex numbers are packed, three per triangle.
  COLLIDE_HD bool packed_indices() const { return triangle_stride_ == 3 && corner_stride_ == 1; }

 private:
  point_view<S> vertices_;
  id const* indices_ = nullptr;
  std::size_t size_ = 0;
  unsigned triangle_stride_ = 3;
  unsigned corner_stride_ = 1;
};

namespace detail {

/// A pointer to vertex numbers as `mesh_view` keeps it.
template <class Index>
id const* as_ids(Index const* indices, std::size_t triangle_count) {
  static_assert(std::is_integral<Index>::value && sizeof(Index) == sizeof(id),
                "collide: the indices of an indexed mesh are 32-bit integers");
  check_array(indices, 3 * triangle_count, "indices");
  return reinterpret_cast<id const*>(indices);
}

}  // namespace detail

/// View of an indexed mesh: `vertices` as `points` gives them, `indices` 3 * `triangle_count` vertex numbers from 0, of
/// any 32-bit integer type. O(1). Throws `error` if there are more than 2^32 - 2 triangles, or an address is null where
/// there are some.
template <class S, class Index>
mesh_view<S> indexed_mesh(point_view<S> const& vertices, Index const* indices, std::size_t triangle_count) {
  return {vertices, detail::as_ids(indices, triangle_count), triangle_count};
}

/// View of an indexed mesh with packed vertices: `vertices` holds 3 * `vertex_count` coordinates, `indices` 3 *
/// `triangle_count` vertex numbers from 0, of any 32-bit integer type. O(1). Throws `error` if there are more than
/// 2^32 - 2 triangles, or an address is null where there are some.
template <class S, class Index>
mesh_view<S> indexed_mesh(S const* vertices, std::size_t vertex_count, Index const* indices,
                          std::size_t triangle_count) {
  return {points(vertices, vertex_count), detail::as_ids(indices, triangle_count), triangle_count};
}

/// View of an indexed mesh in Eigen matrices of either storage order, such as libigl's V and F: a row of F holds three
/// row numbers of V, of any 32-bit integer type. Where the type of a matrix has 3 rows, its columns take the place of
/// rows; see `points`. O(1). Throws `error` if a matrix has another shape, or there are more than 2^32 - 2 triangles.
template <class V, class F, class = std::enable_if_t<detail::is_eigen<V> && detail::is_eigen<F>>>
mesh_view<typename std::decay_t<V>::Scalar> indexed_mesh(V&& vertices, F&& faces) {
  static_assert(detail::check_matrix<F>());
  detail::matrix_layout const layout(faces, "a matrix of faces");
  return {points(std::forward<V>(vertices)), detail::as_ids(faces.data(), layout.size), layout.size, layout.stride,
          layout.side};
}

/// View of a triangle soup: `coordinates` holds 9 numbers per triangle, vertex by vertex, each x, y, z. O(1). Throws
/// `error` if there are more than 2^32 - 2 triangles, or some at a null address.
template <class S>
mesh_view<S> triangle_soup(S const* coordinates, std::size_t triangle_count) {
  return {points(coordinates, 3 * triangle_count), nullptr, triangle_count};
}

/// View of a triangle soup of corners as `points` gives them, three per triangle. O(1). Throws `error` if their number
/// is no multiple of three, or there are more than 2^32 - 2 triangles.
template <class S>
mesh_view<S> triangle_soup(point_view<S> const& corners) {
  if (corners.size() % 3 != 0) throw error("collide: triangle_soup: there are not three corners for each triangle");
  return {corners, nullptr, corners.size() / 3};
}

}  // namespace collide
