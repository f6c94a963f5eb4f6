/// \file
/// Points in the caller's memory, as they lie there: packed, in structs, in three arrays, or an Eigen matrix.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include <collide/core/error.hpp>
#include <collide/core/geometry.hpp>

namespace collide {

namespace detail {

/// A stride as the views keep it: a multiplication with 32 bits is cheap on a GPU. Throws `error` if it is negative,
/// and so seems large, or too large.
inline unsigned checked_stride(std::size_t stride) {
  if (stride > std::numeric_limits<unsigned>::max())
    throw error("collide: the stride of an array is negative, or 2^32 or more: copy what it holds to a packed array");
  return static_cast<unsigned>(stride);
}

/// Throws `error` if an array of so many `what` is null.
inline void check_array(void const* array, std::size_t size, char const* what) {
  if (array == nullptr && size != 0)
    throw error("collide: the address of the " + std::string(what) + " is null, but there are " + std::to_string(size) +
                ": give the address of the first, or a size of 0");
}

}  // namespace detail

/// A non-owning view of points: host memory for `host`, device memory for the CUDA spaces. Nothing is copied: the
/// arrays must outlive the view, and the work that reads it. A layout is three addresses and a stride, so one kernel
/// serves all layouts. Made by `points`. Members that read memory are for code that runs where the memory is.
template <class S>
class point_view {
  static_assert(std::is_same<S, float>::value || std::is_same<S, double>::value,
                "collide: points have coordinates of type float or double");

 public:
  using scalar = S;  ///< type of the coordinates: float or double

  /// No points.
  point_view() = default;
  /// Coordinates of point i at x[i * stride], y[i * stride], z[i * stride].
  point_view(S const* x, S const* y, S const* z, std::size_t stride, std::size_t size)
      : x_{x}, y_{y}, z_{z}, size_{size}, stride_{detail::checked_stride(stride)} {}

  /// Throws `error` if there are points, and an address is null; it calls them `what`.
  void check_addresses(char const* what) const {
    for (S const* const array : {x_, y_, z_}) detail::check_array(array, size_, what);
  }

  /// Number of points.
  COLLIDE_HD std::size_t size() const { return size_; }

  /// Point `i`, read from memory.
  COLLIDE_HD_INLINE vec3<S> operator[](std::size_t i) const {
    std::size_t const at = i * stride_;
    return {x_[at], y_[at], z_[at]};
  }

  /// True if they are packed: x0, y0, z0, x1, y1, z1, ...
  COLLIDE_HD bool packed() const { return stride_ == 3 && y_ == x_ + 1 && z_ == x_ + 2; }

  /// Address of the first coordinate of point `i`. If the points are packed the others follow it.
  COLLIDE_HD_INLINE S const* address(std::size_t i) const { return x_ + i * stride_; }

  /// View of the `n` points from number `first` on. O(1); the range must exist.
  point_view subview(std::size_t first, std::size_t n) const {
    std::size_t const skip = first * stride_;
    return {x_ + skip, y_ + skip, z_ + skip, stride_, n};
  }

  /// Calls f(array, stride) for each of the arrays x, y, z. f gets the pointer by reference: the view then reads where
  /// f points it.
  template <class F>
  void for_each_array(F const& f) {
    f(x_, std::size_t{stride_});
    f(y_, std::size_t{stride_});
    f(z_, std::size_t{stride_});
  }

 private:
  S const* x_ = nullptr;
  S const* y_ = nullptr;
  S const* z_ = nullptr;
  std::size_t size_ = 0;
  unsigned stride_ = 3;
};

/// View of `n` points whose coordinates x, y, z lie side by side, one point `stride` coordinates after the other: 3 if
/// they are packed, 4 for points of 16 bytes. O(1). Throws `error` if the stride is negative, or 2^32 or more.
template <class S, class = std::enable_if_t<std::is_arithmetic<S>::value>>
point_view<S> points(S const* xyz, std::size_t n, std::size_t stride = 3) {
  return {xyz, xyz + 1, xyz + 2, stride, n};
}

/// View of `n` points with their coordinates in three arrays, of which each point takes every `stride`-th element.
/// O(1). Throws `error` if the stride is negative, or 2^32 or more.
template <class S>
point_view<S> points(S const* x, S const* y, S const* z, std::size_t n, std::size_t stride = 1) {
  return {x, y, z, stride, n};
}

/// View of `n` structs with members x, y and z of one type, such as float4, or a vertex with its normal. O(1); no
/// struct is read.
template <class Struct, class S = std::decay_t<decltype(std::declval<Struct const&>().x)>,
          class = std::enable_if_t<std::is_arithmetic<S>::value>>
point_view<S> points(Struct const* structs, std::size_t n) {
  static_assert(sizeof(Struct) % sizeof(S) == 0,
                "collide: the size of a struct with a point is a multiple of the size of a coordinate");
  if (structs == nullptr) return {nullptr, nullptr, nullptr, sizeof(Struct) / sizeof(S), n};
  return {&structs->x, &structs->y, &structs->z, sizeof(Struct) / sizeof(S), n};
}

namespace detail {

/// True for matrices, arrays, maps, blocks and expressions of Eigen.
template <class T>
inline constexpr bool is_eigen = std::is_base_of<Eigen::EigenBase<std::decay_t<T>>, std::decay_t<T>>::value;

/// Checks that a matrix given as `Matrix&&` has memory that a view can read, now and later.
template <class Matrix>
constexpr bool check_matrix() {
  using type = std::decay_t<Matrix>;
  static_assert((int(type::Flags) & int(Eigen::DirectAccessBit)) != 0,
                "collide: an expression of Eigen has no memory that a view can read: keep it in a matrix");
  static_assert(std::is_reference<Matrix>::value || !std::is_base_of<Eigen::PlainObjectBase<type>, type>::value,
                "collide: a temporary matrix is gone when the view of it is read: keep it in a variable");
  return true;
}

/// The rows of an n x 3 matrix as points; the columns, if the type of the matrix has 3 rows. Throws `error` if the
/// matrix has another shape.
struct matrix_layout {
  std::size_t size;
  std::size_t stride;  ///< from one row to the next
  std::size_t side;    ///< from one element of a row to the next

  template <class Matrix>
  matrix_layout(Matrix const& m, char const* what) {
    constexpr bool by_column = int(Matrix::RowsAtCompileTime) == 3 && int(Matrix::ColsAtCompileTime) != 3;
    if ((by_column ? m.rows() : m.cols()) != 3)
      throw error("collide: " + std::string(what) + " has 3 columns, this one is " + std::to_string(m.rows()) + " x " +
                  std::to_string(m.cols()) + "; of one with 3 rows give matrix.transpose()");
    size = static_cast<std::size_t>(by_column ? m.cols() : m.rows());
    stride = static_cast<std::size_t>(by_column ? m.colStride() : m.rowStride());
    side = static_cast<std::size_t>(by_column ? m.rowStride() : m.colStride());
  }
};

}  // namespace detail

/// View of an Eigen matrix of either storage order, or of a map or a block of one: each row is a point, as libigl has
/// them, but in a matrix whose type has 3 rows, such as Eigen::Matrix3Xf, each column is. O(1). Throws `error` if the
/// rows are not of 3 columns. Does not compile for an expression, or for a matrix that is a temporary.
template <class Matrix, class = std::enable_if_t<detail::is_eigen<Matrix>>>
point_view<typename std::decay_t<Matrix>::Scalar> points(Matrix&& matrix) {
  static_assert(detail::check_matrix<Matrix>());
  detail::matrix_layout const layout(matrix, "a matrix of points");
  typename std::decay_t<Matrix>::Scalar const* const x = matrix.data();
  return {x, x + layout.side, x + 2 * layout.side, layout.stride, layout.size};
}

}  // namespace collide
