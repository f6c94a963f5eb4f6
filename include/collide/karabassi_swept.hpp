/// \file
/// Karabassi's intersection test for moving spheres: continuous collision detection.
#pragma once

#include <collide/core/impact.hpp>
#include <collide/core/precision.hpp>
#include <collide/narrow/detail/contact_in_precision.hpp>
#include <collide/narrow/detail/contact_swept.hpp>
#include <collide/narrow/detail/intersects_swept.hpp>
#include <collide/narrow/detail/karabassi_swept_test.hpp>
#include <collide/narrow/detail/time_of_impact.hpp>

namespace collide {

/// Narrow phase: the particle/triangle test of E.-A. Karabassi, G. Papaioannou, T. Theoharis and A. Boehm,
/// "Intersection test for collision detection in particle systems", J. Graphics Tools 4(1), 1999: a sphere sweeps out a
/// cylinder with spherical caps within a step. Tells whether the triangle touches it, the first time of contact, and
/// the contact then.
///
/// `Precision` is the precision of the test and of contacts: `exact` (verdicts are never wrong), `double_precision` or
/// `single_precision`. It does not change the time of impact.
///
/// A degenerate triangle is treated as a segment or a point. A NaN or infinite coordinate or displacement and a NaN or
/// negative radius never collide; an infinite radius always does where the geometry is finite. A sphere that does not
/// move collides if and only if it does with `karabassi`.
template <class Precision = exact>
struct karabassi_swept {
  static_assert(
      detail::is_precision<Precision>::value && !std::is_same<Precision, baseline>::value,
      "collide: the parameter of karabassi_swept is exact, double_precision, single_precision or a precision of "
      "your own: a class with a member type scalar");

  /// True if the sphere touches the triangle at some time of the step, boundaries included. O(1).
  template <class S>
  static COLLIDE_HD_INLINE bool intersects(triangle<S> const& t, moving_sphere<S> const& s) {
    if constexpr (std::is_same<Precision, exact>::value) {
      return detail::intersects_exact(t, s).hit;
    } else {
      return detail::karabassi_swept_local<typename Precision::scalar>(t, s);
    }
  }

  /// First time of contact of a colliding pair, as a fraction of the step, 0 to 1: never later than in exact
  /// arithmetic, and earlier by at most 2^-23 for floats and 2^-30 for doubles. 0 if the two overlap at the beginning.
  template <class S>
  static COLLIDE_HD S time_of_impact(triangle<S> const& t, moving_sphere<S> const& s) {
    return detail::time_of_impact(t, s);
  }

  /// Contact of a colliding pair at its time of impact; the caller sets the ids.
  template <class S>
  static COLLIDE_HD contact<S> contact_of(triangle<S> const& t, moving_sphere<S> const& s) {
    return impact_of(t, s).contact;
  }

  /// Time of impact and contact of a colliding pair; the caller sets the ids. The depth is that of an overlap at the
  /// beginning of the step, else next to zero.
  template <class S>
  static COLLIDE_HD impact<S> impact_of(triangle<S> const& t, moving_sphere<S> const& s) {
    S const time = time_of_impact(t, s);
    if constexpr (std::is_same<Precision, exact>::value) {
      return {detail::contact_at_time(t, s, time), time};
    } else {
      return {detail::contact_at_time_in_precision<typename Precision::scalar>(t, s, time), time};
    }
  }
};

namespace detail {

template <>
struct filtered_predicate<karabassi_swept<exact>> : exact_swept_predicate {};

}  // namespace detail

}  // namespace collide
