/// \file
/// Views of a set of spheres in the caller's memory: packed, separate arrays or quadruples; one radius or one each.
#pragma once

#include <cstddef>
#include <limits>
#include <type_traits>

#include <collide/error.hpp>
#include <collide/geometry.hpp>

namespace collide {

/// A non-owning view of spheres: host memory for `host`, device memory for the CUDA spaces. Nothing is copied. A layout
/// is a set of strides, so one kernel serves all layouts. Made by `spheres_xyz`, `spheres_soa` and `spheres_xyzr`.
template <class S>
class sphere_view {
  static_assert(std::is_same<S, float>::value || std::is_same<S, double>::value,
                "collide: spheres have coordinates of type float or double");

 public:
  using scalar = S;

  sphere_view() = default;
  /// Coordinates of sphere i at x[i * stride], y[i * stride], z[i * stride]; its radius at radii[i * radius_stride], or
  /// `radius` for all if `radii` is null.
  sphere_view(S const* x, S const* y, S const* z, std::size_t stride, S const* radii, std::size_t radius_stride,
              S radius, std::size_t size)
      : x_{x},
        y_{y},
        z_{z},
        radii_{radii},
        stride_{static_cast<unsigned>(stride)},
        radius_stride_{static_cast<unsigned>(radius_stride)},
        radius_{radius},
        size_{size} {
    constexpr std::size_t widest = std::numeric_limits<unsigned>::max();
    if (stride > widest || radius_stride > widest) throw error("collide: the stride of a sphere set is too large");
    if (size >= no_id) throw error("collide: a sphere set has at most 2^32 - 2 spheres");
  }

  /// Number of spheres.
  COLLIDE_HD std::size_t size() const { return size_; }

  /// Centre of sphere `i`, read from memory.
  COLLIDE_HD_INLINE vec3<S> centre(std::size_t i) const { return {*x(i), *y(i), *z(i)}; }

  /// Radius of sphere `i`, read from memory unless all have one.
  COLLIDE_HD_INLINE S radius(std::size_t i) const { return radii_ == nullptr ? radius_ : radii_[i * radius_stride_]; }

  /// Sphere `i`, read from memory.
  COLLIDE_HD_INLINE sphere<S> operator[](std::size_t i) const { return {centre(i), radius(i)}; }

  /// Addresses of the coordinates of sphere `i`.
  COLLIDE_HD_INLINE S const* x(std::size_t i) const { return x_ + i * stride_; }
  COLLIDE_HD_INLINE S const* y(std::size_t i) const { return y_ + i * stride_; }
  COLLIDE_HD_INLINE S const* z(std::size_t i) const { return z_ + i * stride_; }

  /// True if all spheres have the radius `common_radius()`.
  COLLIDE_HD bool one_radius() const { return radii_ == nullptr; }
  /// The radius of all spheres; 0 if each has its own.
  COLLIDE_HD S common_radius() const { return radius_; }

  /// True if the centres are packed: x0, y0, z0, x1, y1, z1, ...
  COLLIDE_HD bool packed() const { return stride_ == 3 && y_ == x_ + 1 && z_ == x_ + 2; }

  /// View of the `n` spheres from number `first` on. O(1); the range must exist.
  sphere_view subview(std::size_t first, std::size_t n) const {
    S const* const radii = radii_ == nullptr ? nullptr : radii_ + first * radius_stride_;
    return {x(first), y(first), z(first), stride_, radii, radius_stride_, radius_, n};
  }

  /// Calls f(array, stride) for each array that the view reads. f gets the pointer by reference: the view then reads
  /// where f points it.
  template <class F>
  void for_each_array(F const& f) {
    f(x_, std::size_t{stride_});
    f(y_, std::size_t{stride_});
    f(z_, std::size_t{stride_});
    if (radii_ != nullptr) f(radii_, std::size_t{radius_stride_});
  }

 private:
  S const* x_ = nullptr;
  S const* y_ = nullptr;
  S const* z_ = nullptr;
  S const* radii_ = nullptr;
  unsigned stride_ = 3;
  unsigned radius_stride_ = 1;
  S radius_ = 0;
  std::size_t size_ = 0;
};

/// `n` spheres with packed centres (3 `n` coordinates) and one radius.
template <class S>
sphere_view<S> spheres_xyz(S const* xyz, std::size_t n, std::common_type_t<S> radius) {
  return {xyz, xyz + 1, xyz + 2, 3, nullptr, 0, radius, n};
}

/// `n` spheres with packed centres (3 `n` coordinates) and `n` radii.
template <class S>
sphere_view<S> spheres_xyz(S const* xyz, std::size_t n, S const* radii) {
  return {xyz, xyz + 1, xyz + 2, 3, radii, 1, S(0), n};
}

/// `n` spheres with the coordinates of their centres in three arrays and one radius.
template <class S>
sphere_view<S> spheres_soa(S const* x, S const* y, S const* z, std::size_t n, std::common_type_t<S> radius) {
  return {x, y, z, 1, nullptr, 0, radius, n};
}

/// `n` spheres with the coordinates of their centres in three arrays and `n` radii.
template <class S>
sphere_view<S> spheres_soa(S const* x, S const* y, S const* z, std::size_t n, S const* radii) {
  return {x, y, z, 1, radii, 1, S(0), n};
}

/// `n` spheres as quadruples (x, y, z, r), such as an array of float4.
template <class S>
sphere_view<S> spheres_xyzr(S const* xyzr, std::size_t n) {
  return {xyzr, xyzr + 1, xyzr + 2, 4, xyzr + 3, 4, S(0), n};
}

}  // namespace collide
