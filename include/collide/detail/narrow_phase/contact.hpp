/// \file
/// The contact of a colliding pair.
#pragma once

#include <collide/detail/geometry/closest_point.hpp>
#include <collide/detail/predicates/exact.hpp>

namespace collide::detail {

/// Unit vector along `v`, which is not zero.
template <class T>
COLLIDE_HD inline vec3<T> unit(vec3<T> const& v) {
  vec3<T> const w = scaled(v, reciprocal_power(magnitude(v)));
  return scaled(w, div(T(1), root(dot(w, w))));
}

/// A unit vector perpendicular to `v`, or (0, 0, 1) if `v` is zero.
template <class T>
COLLIDE_HD inline vec3<T> perpendicular(vec3<T> const& v) {
  vec3<T> const m = v.cwiseAbs();
  if (m.x() == 0 && m.y() == 0) return m.z() == 0 ? vec3<T>{0, 0, 1} : vec3<T>{1, 0, 0};
  return m.z() >= larger(m.x(), m.y()) ? unit<T>({0, -v.z(), v.y()}) : unit<T>({-v.y(), v.x(), 0});
}

/// What exact arithmetic tells of a contact.
struct exact_measure {
  gap measured;
  vec3<double> normal;
  feature kind;
  int index;
};

/// What doubles cannot tell of a contact: distance and depth of the closest foot to nearly all digits, however small
/// they are, and its direction. `exactly()` makes an `exact_triangle`; doubles take `distance_squared` for the square
/// of the distance.
template <class Exactly>
COLLIDE_HD_NOINLINE exact_measure measure_exactly(Exactly const& exactly, local_triangle<double> const& l,
                                                  double distance_squared) {
  auto const e = exactly();
  gap measured{0, 0};
  auto const f = e.nearest(l, distance_squared, measured);
  vec3<double> normal = f.towards_centre();
  if (magnitude(normal) == 0) normal = e.normal();
  if (magnitude(normal) == 0) {  // a segment or a point, and the centre lies on it
    vec3<double> const ab = l.b - l.a, bc = l.c - l.b, ca = l.a - l.c;
    double const x = dot(ab, ab), y = dot(bc, bc), z = dot(ca, ca);
    normal = perpendicular(x >= y && x >= z ? ab : (y >= z ? bc : ca));
  } else {
    normal = unit(normal);
  }
  return {measured, normal, f.kind, f.index};
}

/// Doubles are sure of a length from here on, in a problem of at most size 4: to within 2^-45; see docs/numerics.md.
inline constexpr double clear_length = 0x1p-20;

/// The contact of a finite triangle, as seen from `centre`, computed in double and rounded once, if the digits of a
/// double suffice: `clear(distance, depth)`, both local, tells whether they do. If not, `otherwise(q, measured,
/// normal)` may correct what was computed; false if that returns false. The ids are left to the caller.
template <class S, class Clear, class Otherwise>
COLLIDE_HD_INLINE bool contact_if_clear(local_triangle<double> const& l, vec3<double> const& centre, S radius,
                                        Clear const& clear, Otherwise const& otherwise, contact<S>& found) {
  vec3<double> normal = cross<double>(l.b - l.a, l.c - l.a);
  closest_point<double> q = closest_to_origin(l, normal);
  double const local_distance = root(q.distance_squared);
  gap measured{div(local_distance, l.scale), 0};
  measured.depth = static_cast<double>(radius) - measured.distance;
  if (!clear(local_distance, mul(measured.depth, l.scale))) {
    if (!otherwise(q, measured, normal)) return false;
    if (infinite(radius)) measured.depth = static_cast<double>(radius);
  } else if (q.kind == feature::face) {
    normal = unit(normal);
    if (dot(l.a, normal) > 0) normal = -normal;
  } else {
    normal = unit<double>(-q.point);
  }
  vec3<double> point = centre + scaled(q.point, div(1.0, l.scale));
  if (!finite(point)) {  // the way there is longer than the largest number, or rounded up to more than that
    constexpr double most = std::numeric_limits<double>::max() / 4;
    point = scaled(centre, 0.25) + scaled(q.point, div(0.25, l.scale));
    for (int k = 0; k < 3; ++k) point[k] = mul(4.0, smaller(larger(point[k], -most), most));
  }
  found = {no_id,
           no_id,
           point.template cast<S>(),
           normal.template cast<S>(),
           static_cast<S>(measured.distance),
           static_cast<S>(measured.depth),
           q.kind,
           static_cast<std::uint32_t>(q.index)};
  return true;
}

/// The same, computed exactly where the digits of a double do not suffice: `exactly()` makes an `exact_triangle`, of
/// what it holds by value.
template <class S, class Clear, class Exactly>
COLLIDE_HD contact<S> contact_from(local_triangle<double> const& l, vec3<double> const& centre, S radius,
                                   Clear const& clear, Exactly const& exactly) {
  auto const otherwise = [&](closest_point<double>& q, gap& measured, vec3<double>& normal) {
    Exactly const how = exactly;  // copies, so that the call does not force the originals into memory
    local_triangle<double> const far = l;
    exact_measure const m = measure_exactly(how, far, q.distance_squared);
    measured = m.measured;
    normal = m.normal;
    q.kind = m.kind;
    q.index = m.index;
    return true;
  };
  contact<S> found;
  contact_if_clear(l, centre, radius, clear, otherwise, found);
  return found;
}

/// The contact of a finite triangle and a sphere.
template <class S>
COLLIDE_HD contact<S> contact_between(triangle<S> const& t, sphere<S> const& s) {
  sphere<S> const centre{s.centre, S(0)};
  local_triangle<double> const l = normalised(relative<double>(t, centre), t, centre);
  auto const clear = [](double distance, double depth) {
    return sizeof(S) == sizeof(float) && distance >= clear_length && (depth >= clear_length || depth <= -clear_length);
  };
  auto const exactly = [t, s = infinite(s.radius) ? centre : s] { return exact_triangle<>(t, s); };
  return contact_from(l, s.centre.template cast<double>(), s.radius, clear, exactly);
}

}  // namespace collide::detail
