/// \file
/// Views of a set of moving spheres, each with a straight path within a step: for continuous collision detection.
#pragma once

#include <collide/spheres.hpp>

namespace collide {

/// A non-owning view of spheres and their displacements within a step: lengths, not velocities. Nothing is copied; what
/// `sphere_view` says of memory holds for displacements too. Made by `with_displacements`.
template <class S>
class moving_sphere_view : public sphere_view<S> {
 public:
  /// No spheres.
  moving_sphere_view() = default;
  /// The displacement of sphere i is displacements[i]. Throws `error` if there are not as many as spheres, or there are
  /// some whose address is null.
  moving_sphere_view(sphere_view<S> const& spheres, point_view<S> const& displacements)
      : sphere_view<S>(spheres), displacements_{displacements} {
    if (displacements.size() != spheres.size()) throw error("collide: there are not as many displacements as spheres");
    displacements.check_addresses("displacements");
  }

  /// The displacements of all spheres.
  COLLIDE_HD_INLINE point_view<S> const& displacements() const { return displacements_; }

  /// Displacement of sphere `i`, read from memory.
  COLLIDE_HD_INLINE vec3<S> displacement(std::size_t i) const { return displacements_[i]; }

  /// Moving sphere `i`, read from memory.
  COLLIDE_HD_INLINE moving_sphere<S> operator[](std::size_t i) const {
    return {sphere_view<S>::operator[](i), displacement(i)};
  }

  /// View of the `n` moving spheres from number `first` on. O(1); the range must exist.
  moving_sphere_view subview(std::size_t first, std::size_t n) const {
    return {sphere_view<S>::subview(first, n), displacements_.subview(first, n)};
  }

  /// Calls f(array, stride) for each array that the view reads, displacements included; see `sphere_view`.
  template <class F>
  void for_each_array(F const& f) {
    sphere_view<S>::for_each_array(f);
    displacements_.for_each_array(f);
  }

 private:
  point_view<S> displacements_;
};

/// View of moving spheres with displacements as `points` gives them. O(1). Throws `error` if there are not as many as
/// spheres.
template <class S, class R>
moving_sphere_view<S> with_displacements(sphere_view<S> const& spheres, point_view<R> const& displacements) {
  static_assert(detail::check_scalars<S, R>());
  return {spheres, displacements};
}

/// View of moving spheres with packed displacements: for n spheres 3 n components x0, y0, z0, x1, ..., in the same kind
/// of memory. O(1).
template <class S, class R>
moving_sphere_view<S> with_displacements(sphere_view<S> const& spheres, R const* displacements) {
  return with_displacements(spheres, points(displacements, spheres.size()));
}

/// View of moving spheres with the components of their displacements in three arrays of n. O(1).
template <class S, class R>
moving_sphere_view<S> with_displacements(sphere_view<S> const& spheres, R const* x, R const* y, R const* z) {
  return with_displacements(spheres, points(x, y, z, spheres.size()));
}

}  // namespace collide
