/// \file
/// Views of a set of moving spheres, each with a straight path within a step: for continuous collision detection.
#pragma once

#include <collide/spheres.hpp>

namespace collide {

/// A non-owning view of spheres and their displacements within a step. Made by `with_displacements`.
template <class S>
class moving_sphere_view : public sphere_view<S> {
 public:
  moving_sphere_view() = default;
  /// The displacement of sphere i is (x[i * stride], y[i * stride], z[i * stride]).
  moving_sphere_view(sphere_view<S> const& spheres, S const* x, S const* y, S const* z, std::size_t stride)
      : sphere_view<S>(spheres), x_{x}, y_{y}, z_{z}, stride_{stride} {}

  /// Displacement of sphere `i`, read from memory.
  COLLIDE_HD_INLINE vec3<S> displacement(std::size_t i) const {
    return {x_[i * stride_], y_[i * stride_], z_[i * stride_]};
  }

  /// Moving sphere `i`, read from memory.
  COLLIDE_HD_INLINE moving_sphere<S> operator[](std::size_t i) const {
    return {sphere_view<S>::operator[](i), displacement(i)};
  }

  /// Address of the x component of the displacement of sphere `i`.
  COLLIDE_HD_INLINE S const* displacements(std::size_t i) const { return x_ + i * stride_; }
  /// True if the displacements are packed: x0, y0, z0, x1, y1, z1, ...
  COLLIDE_HD bool packed_displacements() const { return stride_ == 3 && y_ == x_ + 1 && z_ == x_ + 2; }

  /// View of the `n` moving spheres from number `first` on. O(1); the range must exist.
  moving_sphere_view subview(std::size_t first, std::size_t n) const {
    std::size_t const skip = first * stride_;
    return {sphere_view<S>::subview(first, n), x_ + skip, y_ + skip, z_ + skip, stride_};
  }

  /// Calls f(array, stride) for each array that the view reads, displacements included; see `sphere_view`.
  template <class F>
  void for_each_array(F const& f) {
    sphere_view<S>::for_each_array(f);
    f(x_, stride_);
    f(y_, stride_);
    f(z_, stride_);
  }

 private:
  S const* x_ = nullptr;
  S const* y_ = nullptr;
  S const* z_ = nullptr;
  std::size_t stride_ = 3;
};

/// View of moving spheres with packed displacements: 3 n components. O(1).
template <class S>
moving_sphere_view<S> with_displacements(sphere_view<S> const& spheres, S const* displacements) {
  return {spheres, displacements, displacements + 1, displacements + 2, 3};
}

/// View of moving spheres with the components of their displacements in three arrays of n. O(1).
template <class S>
moving_sphere_view<S> with_displacements(sphere_view<S> const& spheres, S const* x, S const* y, S const* z) {
  return {spheres, x, y, z, 1};
}

}  // namespace collide
