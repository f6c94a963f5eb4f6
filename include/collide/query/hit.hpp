/// \file
/// A colliding pair as a sink sees it.
#pragma once

#include <collide/core/contact.hpp>
#include <collide/mesh.hpp>
#include <collide/narrow/detail/traits.hpp>

namespace collide {

/// A colliding pair as a sink sees it: its ids, and on demand its geometry. Valid only during the call that gets it. It
/// lives where the space runs: on the device, in the CUDA spaces.
template <class NarrowPhase, class S>
class hit {
 public:
  id sphere;    ///< number of the sphere
  id triangle;  ///< number of the triangle

  /// `sphere_view`, or `moving_sphere_view` if the narrow phase judges spheres that move.
  using spheres_type = detail::sphere_view_for<NarrowPhase, S>;

  /// A hit of `p`, whose geometry is in `mesh` and `spheres`: both must outlive it.
  COLLIDE_HD hit(pair p, mesh_view<S> const& mesh, spheres_type const& spheres) : hit(p, mesh, spheres, p.triangle) {}
  /// A hit of triangle p.triangle of a whole mesh, which is triangle `at` of `mesh`, a part of it.
  COLLIDE_HD hit(pair p, mesh_view<S> const& mesh, spheres_type const& spheres, id at)
      : sphere{p.sphere}, triangle{p.triangle}, at_{at}, mesh_{mesh}, spheres_{spheres} {}

  /// Contact of the pair; of a moving sphere, at its time of impact. Computed by this call. The narrow phase needs a
  /// member contact_of.
  COLLIDE_HD collide::contact<S> contact() const {
    static_assert(
        detail::has_contact<NarrowPhase, S>,
        "collide: contacts need a narrow phase with a static member contact_of(triangle, sphere) that returns a "
        "contact");
    collide::contact<S> c = NarrowPhase::contact_of(mesh_[at_], spheres_[sphere]);
    c.sphere = sphere;
    c.triangle = triangle;
    return c;
  }

  /// First time of contact within the step, and the contact at that time. Computed by this call. The narrow phase needs
  /// a member impact_of.
  COLLIDE_HD collide::impact<S> impact() const {
    static_assert(
        detail::has_impact<NarrowPhase, S>,
        "collide: impacts need a narrow phase for spheres that move, with a static member impact_of(triangle, "
        "moving_sphere) that returns an impact, such as karabassi_swept");
    collide::impact<S> i = NarrowPhase::impact_of(mesh_[at_], spheres_[sphere]);
    i.contact.sphere = sphere;
    i.contact.triangle = triangle;
    return i;
  }

 private:
  id at_;
  mesh_view<S> const& mesh_;
  spheres_type const& spheres_;
};

namespace detail {

/// A pair with its geometry.
template <class NarrowPhase, class S>
COLLIDE_HD_INLINE hit<NarrowPhase, S> hit_of(pair p, mesh_view<S> const& mesh,
                                             sphere_view_for<NarrowPhase, S> const& spheres) {
  return {p, mesh, spheres};
}

/// The contact or the impact of a hit.
template <class Record, class NarrowPhase, class S>
COLLIDE_HD_INLINE Record record_of(hit<NarrowPhase, S> const& h) {
  if constexpr (std::is_same<Record, contact<S>>::value)
    return h.contact();
  else
    return h.impact();
}

}  // namespace detail

}  // namespace collide
