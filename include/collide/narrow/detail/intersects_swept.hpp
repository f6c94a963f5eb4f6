/// \file
/// The exact predicate for a moving sphere and a triangle, in stages as in intersects.hpp.
#pragma once

#include <collide/exact/detail/predicates/exact_swept.hpp>
#include <collide/exact/detail/predicates/filter_swept.hpp>
#include <collide/narrow/detail/intersects.hpp>

namespace collide::detail {

/// The stages after the first filter, for the part of a step until `time`. Unless `exact_near_tangency`, a pair that
/// the filter in double leaves uncertain is a hit.
COLLIDE_HD_NOINLINE inline decision intersects_exact_slow(triangle<double> const& t, moving_sphere<double> const& s,
                                                          dyadic time, bool exact_near_tangency = true) {
  if (!is_valid_radius(s.radius) || !is_finite(s.centre) || !is_finite(s.displacement) || !is_finite(t)) {
    return {false, stage::exact_integers};
  }
  if (is_infinite(s.radius)) return {true, stage::exact_integers};
  local_sweep<double> l = to_local<double>(t, s);
  l.path = scaled(l.path, value_of(time));
  double size;
  if (rescale_to_filter_range<double>(l, size)) {
    verdict const v = filtered_test(l, size);
    if (v != verdict::uncertain || !exact_near_tangency) return {v != verdict::miss, stage::double_filter};
  }
  return {intersects_in_integers(t, s, time), stage::exact_integers};
}

template <class S>
COLLIDE_HD_NOINLINE decision intersects_exact_slow(triangle<S> const& t, moving_sphere<S> const& s, dyadic time) {
  return intersects_exact_slow(widened(t), widened(s), time);
}

/// The filter in float. What it leaves `uncertain` is for `resolve_exact`.
template <class S>
COLLIDE_HD_INLINE filter_result filter_exact(triangle<S> const& t, moving_sphere<S> const& s) {
  local_sweep<S> l = to_local<S>(t, s);
  S size;
  if (!rescale_to_filter_range<S>(l, size)) return {verdict::uncertain, stage::single_filter};
  return {filtered_test(narrow_to<float>(l), static_cast<float>(size)), stage::single_filter};
}

/// A filter without branches, from two spheres: `around` contains the whole swept path, `midpoint` lies in the moving
/// sphere at some time.
template <class S>
COLLIDE_HD_INLINE verdict filter_branchless(triangle<S> const& t, sphere<S> const& around, sphere<S> const& midpoint) {
  bool const far = filter_branchless(t, around) == verdict::miss, met = filter_branchless(t, midpoint) == verdict::hit;
  return static_cast<verdict>((2 - static_cast<int>(met)) & -static_cast<int>(!far));
}

/// The stages after the first filter, for any pair.
template <class S>
COLLIDE_HD_INLINE decision resolve_exact(triangle<S> const& t, moving_sphere<S> const& s) {
  triangle<S> const far_triangle = t;  // copies, so that the call does not force the originals into memory
  moving_sphere<S> const far_sphere = s;
  return intersects_exact_slow(far_triangle, far_sphere, dyadic{1, 0});
}

/// True if the sphere touches the triangle at some time of the step, in real arithmetic on the numbers as given.
template <class S>
COLLIDE_HD_INLINE decision intersects_exact(triangle<S> const& t, moving_sphere<S> const& s) {
  filter_result const quick = filter_exact(t, s);
  if (quick.verdict != verdict::uncertain) return {quick.verdict == verdict::hit, quick.decided_by};
  return resolve_exact(t, s);
}

/// The filtered predicate of a narrow phase for moving spheres that decides as `intersects_exact` does.
struct exact_swept_predicate : std::true_type {
  template <class S>
  static COLLIDE_HD_INLINE verdict filter(triangle<S> const& t, moving_sphere<S> const& s) {
    return detail::filter_exact(t, s).verdict;
  }
  template <class S>
  static COLLIDE_HD_INLINE verdict filter_branchless(triangle<S> const& t, sphere<S> const& around,
                                                     sphere<S> const& midpoint) {
    return detail::filter_branchless(t, around, midpoint);
  }
  template <class S>
  static COLLIDE_HD_INLINE bool resolve(triangle<S> const& t, moving_sphere<S> const& s) {
    return detail::resolve_exact(t, s).hit;
  }
};

}  // namespace collide::detail
