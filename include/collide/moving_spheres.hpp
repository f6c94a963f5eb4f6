/// \file
/// Views of a set of spheres that move in a straight line within a step.
#pragma once

#include <collide/spheres.hpp>

namespace collide {

/// Spheres and their displacements within a step, in memory that somebody else owns. Made by `moving`.
template <class S>
class moving_sphere_view : public sphere_view<S> {
 public:
  moving_sphere_view() = default;
  /// The displacement of sphere i is (x[i * stride], y[i * stride], z[i * stride]).
  moving_sphere_view(sphere_view<S> const& spheres, S const* x, S const* y, S const* z, std::size_t stride)
      : sphere_view<S>(spheres), x_{x}, y_{y}, z_{z}, stride_{stride} {}

  COLLIDE_HD_INLINE vec3<S> displacement(std::size_t i) const {
    return {x_[i * stride_], y_[i * stride_], z_[i * stride_]};
  }

  COLLIDE_HD_INLINE moving_sphere<S> operator[](std::size_t i) const {
    return {sphere_view<S>::operator[](i), displacement(i)};
  }

  /// Where the displacement of sphere `i` is, and whether the others follow it as x1, y1, z1, x2, ...
  COLLIDE_HD_INLINE S const* displacements(std::size_t i) const { return x_ + i * stride_; }
  COLLIDE_HD bool packed_displacements() const { return stride_ == 3 && y_ == x_ + 1 && z_ == x_ + 2; }

  /// `n` of the spheres, from number `first` on.
  moving_sphere_view part(std::size_t first, std::size_t n) const {
    std::size_t const skip = first * stride_;
    return {sphere_view<S>::part(first, n), x_ + skip, y_ + skip, z_ + skip, stride_};
  }

  /// See `sphere_view`.
  template <class F>
  void each_array(F const& f) {
    sphere_view<S>::each_array(f);
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

/// Spheres with packed displacements, 3 coordinates each.
template <class S>
moving_sphere_view<S> moving(sphere_view<S> const& spheres, S const* displacements) {
  return {spheres, displacements, displacements + 1, displacements + 2, 3};
}

/// Spheres with the coordinates of their displacements in three arrays.
template <class S>
moving_sphere_view<S> moving(sphere_view<S> const& spheres, S const* x, S const* y, S const* z) {
  return {spheres, x, y, z, 1};
}

}  // namespace collide
