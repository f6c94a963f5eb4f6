/// \file
/// Karabassi's sphere/triangle intersection test.
#pragma once

#include <collide/core/contact.hpp>
#include <collide/core/precision.hpp>
#include <collide/narrow/detail/contact.hpp>
#include <collide/narrow/detail/contact_in_precision.hpp>
#include <collide/narrow/detail/intersects.hpp>
#include <collide/narrow/detail/karabassi_test.hpp>

namespace collide {

/// Narrow phase: the static case of the particle/triangle test of E.-A. Karabassi, G. Papaioannou, T. Theoharis and
/// A. Boehm, "Intersection test for collision detection in particle systems", J. Graphics Tools 4(1), 1999, in four
/// steps: (1) the plane is farther than the radius: miss; (2) a vertex lies in the sphere: hit; (3) the centre projects
/// into the triangle: hit; (4) a point on an edge lies in the sphere: hit; otherwise miss.
///
/// `Precision` is the precision of the test and of contacts: `exact` (verdicts are never wrong, distance and depth are
/// within 4 units in the last place), `double_precision`, `single_precision` or `baseline`; see precision.hpp, and
/// docs/accuracy.md for the cost of each.
///
/// A degenerate triangle is treated as a segment or a point. A NaN or infinite coordinate and a NaN or negative radius
/// never collide; an infinite radius always does where the geometry is finite. (`baseline` promises none of this.)
template <class Precision = exact>
struct karabassi {
  static_assert(detail::is_precision<Precision>::value,
                "collide: the parameter of karabassi is a precision, such as exact or single_precision: a class with a "
                "member type scalar");

  /// True if sphere and triangle, both with their boundaries, have a point in common. O(1).
  template <class S>
  static COLLIDE_HD_INLINE bool intersects(triangle<S> const& t, sphere<S> const& s) {
    if constexpr (std::is_same<Precision, exact>::value) {
      return detail::intersects_exact(t, s).hit;
    } else if constexpr (std::is_same<Precision, baseline>::value) {
      return detail::karabassi_world<float>(t, s);
    } else {
      return detail::karabassi_local<typename Precision::scalar>(t, s);
    }
  }

  /// Contact of a colliding pair; the caller sets the ids. O(1).
  template <class S>
  static COLLIDE_HD contact<S> contact_of(triangle<S> const& t, sphere<S> const& s) {
    if constexpr (std::is_same<Precision, exact>::value) {
      return detail::contact_of_pair(t, s);
    } else {
      return detail::contact_of_pair_in_precision<typename Precision::scalar>(t, s);
    }
  }
};

namespace detail {

template <>
struct filtered_predicate<karabassi<exact>> : exact_predicate {};

}  // namespace detail

}  // namespace collide
