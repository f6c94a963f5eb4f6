/// \file
/// The contact of a colliding pair.
#pragma once

#include <limits>

#include <collide/exact/detail/geometry/closest_point.hpp>
#include <collide/exact/detail/predicates/exact.hpp>
#include <collide/narrow/detail/contact_compensated.hpp>

namespace collide::detail {

/// Distance, depth and normal of a contact in exact arithmetic, to nearly all digits however small they are. `l` is the
/// triangle as seen from where the sphere is at the time, and `distance_squared` what doubles take for the square of
/// its distance.
COLLIDE_HD_NOINLINE inline contact_without_point contact_exact(triangle<double> const& t,
                                                               moving_sphere<double> const& s, double time,
                                                               local_triangle<double> const& l,
                                                               double distance_squared) {
  exact_slot::memory memory;
  exact_triangle const e(exact_numbers_of(memory.table(), t, s, decoded(time)));
  separation measured{0, 0};
  int const closest = e.nearest(l, distance_squared, measured);
  vec3<double> normal = e.direction_to_centre(closest);
  if (max_norm(normal) == 0) normal = e.normal();
  if (max_norm(normal) == 0) {  // a segment or a point, and the centre lies on it
    normal = perpendicular(longest_edge(l));
  } else {
    normal = unit(normal);
  }
  return {measured, normal, exact_triangle::feature_of(closest), exact_triangle::feature_index_of(closest)};
}

/// The smallest length that doubles give to within 2^-45, in a problem of at most size 4; see
/// docs/development/numerics.md.
inline constexpr double well_conditioned_length = 0x1p-20;

/// The contact of a finite triangle, as seen from a sphere's centre, in doubles; `closest` is the point of the
/// triangle. False if their digits do not suffice: `well_conditioned(distance, depth)`, both local, tells whether they
/// do.
template <class WellConditioned>
COLLIDE_HD_INLINE bool contact_if_well_conditioned(local_triangle<double> const& l, double radius,
                                                   WellConditioned const& well_conditioned,
                                                   closest_point<double>& closest, contact_without_point& found) {
  vec3<double> const normal = cross<double>(l.b - l.a, l.c - l.a);
  closest = closest_to_origin(l, normal);
  double const local_distance = sqrt_rn(closest.distance_squared), distance = div_rn(local_distance, l.scale);
  found = {{distance, radius - distance}, normal, closest.kind, closest.index};
  if (!well_conditioned(local_distance, mul_rn(found.measured.depth, l.scale))) return false;
  if (closest.kind == feature::face) {
    found.normal = unit(found.normal);
    if (dot(l.a, found.normal) > 0) found.normal = -found.normal;
  } else {
    found.normal = unit<double>(-closest.point);
  }
  return true;
}

/// The contact at the point `closest`, rounded once; the caller sets the ids.
template <class S>
COLLIDE_HD_INLINE contact<S> contact_at_point(contact_without_point const& m, vec3<double> const& closest, double scale,
                                              vec3<double> const& centre) {
  vec3<double> point = centre + scaled(closest, div_rn(1.0, scale));
  if (!is_finite(point)) {  // the way there is longer than the largest number, or rounded up to more than that
    constexpr double limit = std::numeric_limits<double>::max() / 4;
    point = scaled(centre, 0.25) + scaled(closest, div_rn(0.25, scale));
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) point[k] = mul_rn(4.0, min(max(point[k], -limit), limit));
  }
  return {no_id,
          no_id,
          rounded_to<S>(point),
          rounded_to<S>(m.normal),
          static_cast<S>(m.measured.distance),
          static_cast<S>(m.measured.depth),
          m.kind,
          static_cast<std::uint32_t>(m.index)};
}

template <class S>
COLLIDE_HD contact<S> narrow_to(contact<double> const& c) {
  return {c.sphere,
          c.triangle,
          rounded_to<S>(c.point),
          rounded_to<S>(c.normal),
          static_cast<S>(c.distance),
          static_cast<S>(c.depth),
          c.feature,
          c.feature_index};
}

/// The digits that a contact has.
enum class digits { of_float, of_double };

template <class S>
// guard: double-input
inline constexpr digits digits_of = sizeof(S) == sizeof(float) ? digits::of_float : digits::of_double;

/// The contact of a finite triangle and a sphere where that is at a time, when its centre is where `l` is seen from.
/// Computed exactly where the distance, or with `exact_depth` the depth too, is so small that nothing else will do.
COLLIDE_HD_NOINLINE inline contact<double> contact_with_fallback(local_triangle<double> const& l,
                                                                 vec3<double> const& centre, triangle<double> const& t,
                                                                 moving_sphere<double> const& s, double time,
                                                                 digits wanted, bool exact_depth) {
  constexpr double enough = well_conditioned_length;
  auto const well_conditioned = [&](double distance, double depth) {
    // guard: near-depth
    return wanted == digits::of_float && distance >= enough && (!exact_depth || depth >= enough || depth <= -enough);
  };
  contact_without_point found;
  vec3<double> closest;
  if (wanted == digits::of_double && contact_compensated(t, s, time, l.scale, exact_depth, closest, found)) {
    return contact_at_point<double>(found, closest, l.scale, centre);
  }
  closest_point<double> nearest;
  if (!contact_if_well_conditioned(l, s.radius, well_conditioned, nearest, found)) {
    bool const all = is_infinite(s.radius);
    found = contact_exact(t, {{s.centre, all ? 0 : s.radius}, s.displacement}, time, l, nearest.distance_squared);
    if (all) found.measured.depth = s.radius;
    double const away = mul_rn(found.measured.distance, l.scale);
    if (found.kind != feature::vertex && away <= 4) nearest.point = scaled(found.normal, -away);
  }
  return contact_at_point<double>(found, nearest.point, l.scale, centre);
}

COLLIDE_HD_NOINLINE inline contact<double> contact_of_pair(triangle<double> const& t, sphere<double> const& s,
                                                           digits wanted, bool exact_depth) {
  sphere<double> const centre{s.centre, 0};
  local_triangle<double> const l = to_unit_range(to_local<double>(t, centre), t, centre);
  return contact_with_fallback(l, s.centre, t, {s, {0, 0, 0}}, 0, wanted, exact_depth);
}

template <class S>
COLLIDE_HD contact<S> contact_of_pair(triangle<S> const& t, sphere<S> const& s) {
  return narrow_to<S>(contact_of_pair(widened(t), widened(s), digits_of<S>, true));
}

}  // namespace collide::detail
