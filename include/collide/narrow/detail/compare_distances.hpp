/// \file
/// The distances of two triangles from a point, compared as in exact arithmetic: what is left when doubles do not tell.
#pragma once

#include <collide/exact/detail/predicates/exact_distance.hpp>
#include <collide/exact/detail/predicates/fixed_width_distance.hpp>
#include <collide/narrow/detail/distance_bounds.hpp>

namespace collide::detail {

/// The foot of a finite point on a finite triangle, exactly: corners 0, 1 and 2, edges 3, 4 and 5, the face 6.
COLLIDE_HD_NOINLINE inline int closest_foot(triangle<double> const& t, vec3<double> const& point) {
  fixed_width_units units;
  units.include(point);
  units.include(t);
  return units.fit() ? fixed_width_distance(units, t, point).projection() : closest_foot_in_integers(t, point);
}

/// -1 if the point is nearer to s than to t, 0 if it is as near, else 1: exactly. Finite coordinates.
COLLIDE_HD_NOINLINE inline int compare_distances(triangle<double> const& s, triangle<double> const& t,
                                                 vec3<double> const& point) {
  fixed_width_units units;
  units.include(point);
  units.include(s);
  units.include(t);
  if (!units.fit()) return compare_distances_in_integers(s, t, point);
  return fixed_width_distance::compare(fixed_width_distance(units, s, point), fixed_width_distance(units, t, point));
}

template <class S>
COLLIDE_HD_NOINLINE int compare_distances(triangle<S> const& s, triangle<S> const& t, vec3<S> const& point) {
  return compare_distances(widened(s), widened(t), widened(point));
}

/// True if both feet are one corner, or one edge: then both triangles are as near.
template <class S>
COLLIDE_HD_INLINE bool is_same_foot(triangle<S> const& s, int foot_of_s, triangle<S> const& t, int foot_of_t) {
  if (foot_of_s < 3) return foot_of_t < 3 && is_same_point(corner_of(s, foot_of_s), corner_of(t, foot_of_t));
  if (foot_of_s == 6 || foot_of_t < 3 || foot_of_t == 6) return false;
  vec3<S> const p = corner_of(s, foot_of_s % 3), q = corner_of(s, (foot_of_s + 1) % 3), u = corner_of(t, foot_of_t % 3),
                v = corner_of(t, (foot_of_t + 1) % 3);
  return (is_same_point(p, v) && is_same_point(q, u)) || (is_same_point(p, u) && is_same_point(q, v));
}

}  // namespace collide::detail
