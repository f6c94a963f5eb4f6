/// \file
/// The exact predicate for a moving sphere and a triangle, in stages as in intersects.hpp.
#pragma once

#include <collide/detail/narrow_phase/intersects.hpp>
#include <collide/detail/predicates/exact_swept.hpp>
#include <collide/detail/predicates/filter_swept.hpp>

namespace collide::detail {

/// The stages after the first filter, for the part of a step until `time`. Unless `finely`, a pair that the filter in
/// double leaves uncertain is a hit.
COLLIDE_HD_NOINLINE inline decision decide_closely(triangle<double> const& t, moving_sphere<double> const& s,
                                                   dyadic time, bool finely = true) {
  if (!valid_radius(s.radius) || !finite(s.centre) || !finite(s.displacement) || !finite(t)) {
    return {false, stage::integers};
  }
  if (infinite(s.radius)) return {true, stage::integers};
  local_sweep<double> l = relative<double>(t, s);
  l.path = scaled(l.path, value_of(time));
  double size;
  if (brought_to_size<double>(l, size)) {
    verdict const v = certify(l, size);
    if (v != verdict::unsure || !finely) return {v != verdict::miss, stage::double_certificate};
  }
  return {in_reach_exactly(t, s, time), stage::integers};
}

template <class S>
COLLIDE_HD_NOINLINE decision decide_closely(triangle<S> const& t, moving_sphere<S> const& s, dyadic time) {
  return decide_closely(widened(t), widened(s), time);
}

/// The filter in float. What it leaves `unsure` is for `finish`.
template <class S>
COLLIDE_HD_INLINE attempted attempt(triangle<S> const& t, moving_sphere<S> const& s) {
  local_sweep<S> l = relative<S>(t, s);
  S size;
  if (!brought_to_size<S>(l, size)) return {verdict::unsure, stage::single_certificate};
  return {certify(rounded<float>(l), static_cast<float>(size)), stage::single_certificate};
}

/// A filter without branches, from two spheres: `around` contains the whole swept path, `midway` lies in the moving
/// sphere at some time.
template <class S>
COLLIDE_HD_INLINE verdict attempt_straight(triangle<S> const& t, sphere<S> const& around, sphere<S> const& midway) {
  bool const far = attempt_straight(t, around) == verdict::miss, met = attempt_straight(t, midway) == verdict::hit;
  return static_cast<verdict>((2 - static_cast<int>(met)) & -static_cast<int>(!far));
}

/// The stages after the first filter, for any pair.
template <class S>
COLLIDE_HD_INLINE decision finish(triangle<S> const& t, moving_sphere<S> const& s) {
  triangle<S> const far_triangle = t;  // copies, so that the call does not force the originals into memory
  moving_sphere<S> const far_sphere = s;
  return decide_closely(far_triangle, far_sphere, dyadic{1, 0});
}

/// True if the sphere touches the triangle at some time of the step, in real arithmetic on the numbers as given.
template <class S>
COLLIDE_HD_INLINE decision decide(triangle<S> const& t, moving_sphere<S> const& s) {
  attempted const quick = attempt(t, s);
  if (quick.verdict != verdict::unsure) return {quick.verdict == verdict::hit, quick.by};
  return finish(t, s);
}

}  // namespace collide::detail
