/// \file
/// Time of impact of a moving sphere and a triangle, by conservative advancement.
///
/// The distance of the two is a convex function of time. From a time without contact, any direction in which all of the
/// triangle is farther than the radius gives a later one: that at which the sphere could be there at the earliest. With
/// the direction to the closest point this is Newton's method, from below, and with bounds on all rounding it is never
/// late. How close it came is then decided exactly, on a grid of times; where arithmetic in double was not good enough,
/// as for a sphere that only grazes the triangle, that decides the rest as well.
#pragma once

#include <collide/narrow/detail/intersects_swept.hpp>

namespace collide::detail {

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
    double const least = min(min(dot(l.shape.a, g), dot(l.shape.b, g)), dot(l.shape.c, g));
    double const away = least - mul_rn(outer, sqrt_rn(dot(g, g))), nearer = dot(l.path, g);
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
