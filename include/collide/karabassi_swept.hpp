/// \file
/// Karabassi's intersection test for moving spheres: continuous collision detection.
#pragma once

#include <collide/core/contact.hpp>
#include <collide/core/precision.hpp>
#include <collide/exact/detail/geometry/local_sweep.hpp>
#include <collide/exact/detail/predicates/filter_swept.hpp>
#include <collide/karabassi.hpp>
#include <collide/narrow/detail/contact.hpp>
#include <collide/narrow/detail/contact_in_precision.hpp>
#include <collide/narrow/detail/intersects_swept.hpp>

namespace collide {

namespace detail {

/// The swept test in coordinates local to the start of the path and scaled by a power of two. A hit is reported only
/// for a point of the triangle and a point of the path that were found within the radius of each other.
template <class T, class S>
COLLIDE_HD_INLINE bool karabassi_swept_local(triangle<S> const& of, moving_sphere<S> const& s) {
  using W = std::common_type_t<S, T>;
  local_sweep<W> const l = to_local<W>(of, s);
  if (!aabb_within(l, l.shape.radius + swept_error<W> * max_norm(l))) return false;
  if (!is_valid_radius(s.radius) || !is_finite(s.centre) || !is_finite(s.displacement) || !is_finite(of)) return false;
  if (is_infinite(s.radius)) return true;
  if (max_norm(s.displacement) < std::numeric_limits<S>::min()) {
    return karabassi_local<T>(of, static_cast<sphere<S> const&>(s));
  }
  local_sweep<T> const t = narrow_to<T>(to_unit_range(l, of, s));
  return approach(t).distance_squared <= mul_rn(t.shape.radius, t.shape.radius);
}

/// The contact at a time within the step. At the time of impact its depth is next to zero, and accurate to absolute
/// rounding only.
COLLIDE_HD_NOINLINE inline contact<double> contact_at_time(triangle<double> const& t, moving_sphere<double> const& s,
                                                           double time, digits wanted) {
  if (time == 0) return contact_of_pair(t, static_cast<sphere<double> const&>(s), wanted, true);
  moving_sphere<double> const centre{{s.centre, 0}, s.displacement};
  local_sweep<double> const l = to_unit_range(to_local<double>(t, centre), t, centre);
  return contact_with_fallback(at_time(l, time), s.centre + scaled(s.displacement, time), t, s, time, wanted, false);
}

template <class S>
COLLIDE_HD contact<S> contact_at_time(triangle<S> const& t, moving_sphere<S> const& s, S time) {
  return narrow_to<S>(contact_at_time(widened(t), widened(s), static_cast<double>(time), digits_of<S>));
}

}  // namespace detail

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
