/// \file
/// Contacts in plain arithmetic, without an error bound: those of the precisions other than `exact`.
#pragma once

#include <collide/exact/detail/geometry/local_sweep.hpp>
#include <collide/narrow/detail/contact.hpp>

namespace collide::detail {

/// From the triangle to the centre, which sees it from the origin: of length 1 whatever the two are.
template <class T>
COLLIDE_HD_INLINE vec3<T> contact_normal(local_triangle<T> const& t, vec3<T> const& n,
                                         closest_point<T> const& closest) {
  if (max_norm(n) == 0 || (closest.kind != feature::face && max_norm(closest.point) > 0)) {
    return max_norm(closest.point) > 0 ? unit<T>(-closest.point) : perpendicular(longest_edge(t));
  }
  vec3<T> const normal = unit(n);
  return dot(closest.point, normal) > 0 ? vec3<T>(-normal) : normal;
}

/// The contact of a sphere and a triangle in `T`. `l` is the triangle as seen from the sphere, in the range of
/// `to_unit_range`, and `scale` that of `l`.
template <class S, class T>
COLLIDE_HD contact<S> contact_in_precision(local_triangle<T> const& l, double scale, S radius,
                                           vec3<double> const& centre) {
  vec3<T> const n = cross<T>(l.b - l.a, l.c - l.a);
  closest_point<T> const closest = closest_to_origin(l, n);
  double const distance = div_rn(static_cast<double>(sqrt_rn(closest.distance_squared)), scale);
  contact_without_point const found{{distance, static_cast<double>(radius) - distance},
                                    cast_to<double>(contact_normal(l, n, closest)),
                                    closest.kind,
                                    closest.index};
  return contact_at_point<S>(found, cast_to<double>(closest.point), scale, centre);
}

/// The contact of a finite triangle and a sphere at rest in `T`.
template <class T, class S>
COLLIDE_HD_NOINLINE contact<S> contact_of_pair_in_precision(triangle<S> const& t, sphere<S> const& s) {
  using W = std::common_type_t<S, T>;
  sphere<S> const centre{s.centre, 0};
  local_triangle<W> const l = to_unit_range(to_local<W>(t, centre), t, centre);
  return contact_in_precision(narrow_to<T>(l), static_cast<double>(l.scale), s.radius, cast_to<double>(s.centre));
}

/// The contact of a finite triangle and a moving sphere, at a time within the step, in `T`.
template <class T, class S>
COLLIDE_HD_NOINLINE contact<S> contact_at_time_in_precision(triangle<S> const& t, moving_sphere<S> const& s, S time) {
  using W = std::common_type_t<S, T>;
  moving_sphere<S> const centre{{s.centre, 0}, s.displacement};
  local_sweep<W> const l = to_unit_range(to_local<W>(t, centre), t, centre);
  vec3<double> const path = cast_to<double>(s.displacement);
  return contact_in_precision(narrow_to<T>(at_time(l, static_cast<W>(time))), static_cast<double>(l.shape.scale),
                              s.radius, cast_to<double>(s.centre) + scaled(path, static_cast<double>(time)));
}

}  // namespace collide::detail
