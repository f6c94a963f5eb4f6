/// \file
/// The exact predicate for a moving sphere and a triangle, in stages as in intersects.hpp, and the time of impact.
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

/// The time is found to within 2^-time_bits<S>, and then rounded down to S.
template <class S>
inline constexpr int time_bits = sizeof(S) == sizeof(float) ? 25 : 31;

/// A lower bound of the time of impact, from 0 to 1, by conservative advancement.
COLLIDE_HD_NOINLINE inline double conservative_advancement(triangle<double> const& t, moving_sphere<double> const& s) {
  constexpr int enough = 40;  // for a tangent way each step halves what is left; else a few do
  local_sweep<double> l = to_local<double>(t, s);
  double size;
  if (!rescale_to_filter_range<double>(l, size)) return 0;
  double const outer = l.shape.radius + swept_error<double> * size;
  vec3<double> const n = cross<double>(l.shape.b - l.shape.a, l.shape.c - l.shape.a);
  double time = 0;
  for (int i = 0; i < enough; ++i) {
    vec3<double> const g = closest_to_origin(at_time(l, time), n).point;
    double const lowest = min(min(dot(l.shape.a, g), dot(l.shape.b, g)), dot(l.shape.c, g));
    double const away = lowest - mul_rn(outer, sqrt_rn(dot(g, g))), nearer = dot(l.path, g);
    if (!(away > 0 && nearer > 0)) return time;
    double const next = div_rn(away, nearer);
    if (!(next > time)) return time;
    if (next >= 1) return 1;
    time = next;
  }
  return time;
}

/// The largest number of `S` that is not above x, for x >= 0.
template <class S>
COLLIDE_HD S rounded_down(double x) {
  S const nearest = static_cast<S>(x);
  return static_cast<double>(nearest) > x ? from_bits<S>(to_bits(nearest) - 1) : nearest;
}

/// Never later than the first contact, and earlier by at most 2^-bits. Unless `exact_near_tangency`, contact is also
/// what doubles leave open, next to tangency.
COLLIDE_HD_NOINLINE inline double refine_time_of_impact(triangle<double> const& t, moving_sphere<double> const& s,
                                                        int bits, bool exact_near_tangency) {
  double const time = conservative_advancement(t, s);
  std::uint32_t const steps = std::uint32_t{1} << bits;
  // no contact until `lower` steps, or just then; contact until `hit` steps
  auto lower = min(static_cast<std::uint32_t>(time * steps), steps - 1), hit = steps;
  for (std::uint32_t step = 1; hit - lower > 1;) {
    std::uint32_t const middle = lower + min(step, (hit - lower) / 2);
    if (intersects_exact_slow(t, s, reduced(middle, -bits), exact_near_tangency).hit) {
      hit = middle;
    } else {
      lower = middle;
      if (step < steps) step *= 2;
    }
  }
  return max(time, lower * value_of({1, -bits}));
}

/// Time of impact in double, to within 2^-bits, before it is rounded to the scalar.
COLLIDE_HD_NOINLINE inline double time_of_impact(triangle<double> const& t, moving_sphere<double> const& s, int bits) {
  if (intersects_exact_slow(t, static_cast<sphere<double> const&>(s)).hit) return 0;
  if (!intersects_exact_slow(t, s, dyadic{1, 0}).hit) return approach(to_unit_range(to_local<double>(t, s), t, s)).time;
  return refine_time_of_impact(t, s, bits, true);
}

/// Never later than the first contact, and earlier by at most 2^-23 for floats and 2^-30 for doubles. 0 if the two
/// overlap at the beginning. Of a sphere that does not touch the triangle at all: about when it is closest.
template <class S>
COLLIDE_HD_NOINLINE S time_of_impact(triangle<S> const& t, moving_sphere<S> const& s) {
  return rounded_down<S>(time_of_impact(widened(t), widened(s), time_bits<S>));
}

}  // namespace collide::detail
