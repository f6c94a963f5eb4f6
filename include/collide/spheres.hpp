/// \file
/// Views of a set of spheres in the caller's memory: centres in any layout of points.hpp; one radius or one each.
#pragma once

#include <cstddef>
#include <type_traits>

#include <collide/core/error.hpp>
#include <collide/core/points.hpp>

namespace collide {

/// A non-owning view of spheres: host memory for `host`, device memory for the CUDA spaces. Nothing is copied: the
/// arrays must outlive the view, and the queries that read it. A layout is a set of strides, so one kernel serves all
/// layouts. Lengths are in any unit, the one of the mesh. Made by `spheres_at`, `spheres_xyz`, `spheres_soa` and
/// `spheres_xyzr`. Members that read memory are for code that runs where the memory is.
template <class S>
class sphere_view {
  static_assert(std::is_same<S, float>::value || std::is_same<S, double>::value,
                "collide: spheres have coordinates of type float or double");

 public:
  using scalar = S;  ///< type of the coordinates: float or double

  /// No spheres.
  sphere_view() = default;
  /// The radius of sphere i is at radii[i * radius_stride], or `radius` for all if `radii` is null. Throws `error` if
  /// there are more than 2^32 - 2 spheres, a stride is negative or 2^32 or more, or there are centres whose address is
  /// null.
  sphere_view(point_view<S> const& centres, S const* radii, std::size_t radius_stride, S radius)
      : centres_{centres}, radii_{radii}, radius_stride_{detail::checked_stride(radius_stride)}, radius_{radius} {
    if (centres.size() >= no_id) throw error("collide: a sphere set has at most 2^32 - 2 spheres");
    centres.check_addresses("centres");
  }

  /// Number of spheres.
  COLLIDE_HD std::size_t size() const { return centres_.size(); }

  /// The centres of all spheres.
  COLLIDE_HD_INLINE point_view<S> const& centres() const { return centres_; }

  /// Centre of sphere `i`, read from memory.
  COLLIDE_HD_INLINE vec3<S> centre(std::size_t i) const { return centres_[i]; }

  /// Radius of sphere `i`, read from memory unless all have one.
  COLLIDE_HD_INLINE S radius(std::size_t i) const { return radii_ == nullptr ? radius_ : radii_[i * radius_stride_]; }

  /// Sphere `i`, read from memory.
  COLLIDE_HD_INLINE sphere<S> operator[](std::size_t i) const { return {centre(i), radius(i)}; }

  /// True if all spheres have the radius `common_radius()`.
  COLLIDE_HD bool one_radius() const { return radii_ == nullptr; }
  /// The radius of all spheres; 0 if each has its own.
  COLLIDE_HD S common_radius() const { return radius_; }

  /// View of the `n` spheres from number `first` on. O(1); the range must exist.
  sphere_view subview(std::size_t first, std::size_t n) const {
    S const* const radii = radii_ == nullptr ? nullptr : radii_ + first * radius_stride_;
    return {centres_.subview(first, n), radii, radius_stride_, radius_};
  }

  /// Calls f(array, stride) for each array that the view reads. f gets the pointer by reference: the view then reads
  /// where f points it.
  template <class F>
  void for_each_array(F const& f) {
    centres_.for_each_array(f);
    if (radii_ != nullptr) f(radii_, std::size_t{radius_stride_});
  }

 private:
  point_view<S> centres_;
  S const* radii_ = nullptr;
  unsigned radius_stride_ = 1;
  S radius_ = 0;
};

namespace detail {

template <class S, class R>
constexpr bool check_scalars() {
  static_assert(std::is_same<S, R>::value,
                "collide: centres, radii and displacements of spheres have one scalar type, that of the detector: copy "
                "floats to double, which is exact");
  return true;
}

}  // namespace detail

/// Spheres of one radius whose centres are as `points` gives them. O(1). Throws `error` if there are more than
/// 2^32 - 2.
template <class S>
sphere_view<S> spheres_at(point_view<S> const& centres, std::common_type_t<S> radius) {
  return {centres, nullptr, 0, radius};
}

/// Spheres whose centres are as `points` gives them, with a radius each: every `radius_stride`-th of `radii`. O(1).
/// Throws `error` if there are more than 2^32 - 2 spheres, `radii` is null, or the stride is 2^32 or more.
template <class S, class R>
sphere_view<S> spheres_at(point_view<S> const& centres, R const* radii, std::size_t radius_stride = 1) {
  static_assert(detail::check_scalars<S, R>());
  detail::check_array(radii, centres.size(), "radii");
  return {centres, radii, radius_stride, S(0)};
}

/// `n` spheres with packed centres and one radius: `xyz` holds 3 n coordinates x0, y0, z0, x1, ... A radius that is
/// negative or NaN makes all of them empty. O(1). Throws `error` if there are more than 2^32 - 2 spheres, or the
/// address is null.
template <class S>
sphere_view<S> spheres_xyz(S const* xyz, std::size_t n, std::common_type_t<S> radius) {
  return {points(xyz, n), nullptr, 0, radius};
}

/// `n` spheres with packed centres and a radius each: `xyz` holds 3 n coordinates x0, y0, z0, x1, ..., and `radii` n
/// numbers in the same kind of memory. O(1). Throws `error` if there are more than 2^32 - 2 spheres, or an address is
/// null.
template <class S, class R>
sphere_view<S> spheres_xyz(S const* xyz, std::size_t n, R const* radii) {
  return spheres_at(points(xyz, n), radii);
}

/// `n` spheres with the coordinates of their centres in three arrays of n, and one radius. O(1). Throws `error` if
/// there are more than 2^32 - 2 spheres, or an address is null.
template <class S>
sphere_view<S> spheres_soa(S const* x, S const* y, S const* z, std::size_t n, std::common_type_t<S> radius) {
  return {points(x, y, z, n), nullptr, 0, radius};
}

/// `n` spheres with the coordinates of their centres in three arrays of n, and `n` radii. O(1). Throws `error` if there
/// are more than 2^32 - 2 spheres, or an address is null.
template <class S, class R>
sphere_view<S> spheres_soa(S const* x, S const* y, S const* z, std::size_t n, R const* radii) {
  return spheres_at(points(x, y, z, n), radii);
}

/// `n` spheres as quadruples: `xyzr` holds 4 n numbers x0, y0, z0, r0, x1, ..., such as an array of float4. O(1).
/// Throws `error` if there are more than 2^32 - 2 spheres, or the address is null.
template <class S>
sphere_view<S> spheres_xyzr(S const* xyzr, std::size_t n) {
  return {points(xyzr, n, 4), xyzr + 3, 4, S(0)};
}

}  // namespace collide
