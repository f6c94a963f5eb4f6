/// \file
/// A moving sphere and a triangle in exact arithmetic.
///
/// The way of the centre and the triangle are closest where one of these is the case:
///   - the way begins or ends, and there the triangle is closest: see exact_triangle.hpp;
///   - the way goes through the triangle;
///   - the foot of a corner lies inside the way;
///   - the common perpendicular of way and edge has its feet inside of both.
/// The sphere touches the triangle if and only if one of these, where it exists, is within the radius. With the way d,
/// a corner v and the next v' as seen from the beginning and w from the end, the edge e from v to v', the normal n of
/// the triangle, and m = d x e:
///
///                it exists if                                                          squared distance
///     through    v.n and w.n differ in sign, all three d.(v x e) do not                0
///     corner     v.d > 0 and w.d < 0                                                   |v x d|^2 / d.d
///     edge       (v x e).m > 0, (w x e).m < 0, (v x d).m > 0 and (v' x d).m < 0        (v.m)^2 / m.m
///
/// All of these are sums of products of at most six factors. Where something is parallel or zero, the distance is
/// found at another of these places.
#pragma once

#include <collide/detail/predicates/exact.hpp>

namespace collide::detail {

/// Of how many parts time * displacement may be. For floats it has one, so a time may have 29 bits.
template <class S>
inline constexpr int path_parts = sizeof(S) == sizeof(float) ? 1 : 4;

/// The way until a time.
template <class S>
struct exact_path {
  exact_vector<path_parts<S>> to;

  COLLIDE_HD exact_path(vec3<S> const& displacement, dyadic time) {
    for (int k = 0; k < 3; ++k) to[k] = product<path_parts<S>>(decoded(displacement[k]), time);
  }
};

/// Finite coordinates and a finite radius, not below 0.
template <class S>
class exact_sweep {
 public:
  /// The first part of a step, until `time`.
  COLLIDE_HD exact_sweep(triangle<S> const& t, moving_sphere<S> const& s, dyadic time)
      : path_(s.displacement, time), start_(t, s), end_(t, s, path_.to) {}

  /// True if the ball touches the triangle on its way.
  COLLIDE_HD bool in_reach() const {
    if (start_.in_reach() || end_.in_reach() || through_face()) return true;
    for (int i = 0; i < 3; ++i) {
      if ((beside_corner(i) && corner_within(i)) || (across_edge(i) && edge_within(i))) return true;
    }
    return false;
  }

 private:
  /// The sign of what `terms` sums.
  template <class Terms>
  static COLLIDE_HD int sign(Terms const& terms) {
    return exact_sum::sign_of(terms);
  }

  COLLIDE_HD bool through_face() const {
    auto const &p = start_.edge(0), &q = start_.edge(1);
    int const before = sign([&](auto const& add) { sum_determinant(1, start_.corner(0), p, q, add); });
    if (before == 0) return false;
    if (sign([&](auto const& add) { sum_determinant(before, end_.corner(0), p, q, add); }) >= 0) return false;
    int const side = passes(0);
    return side != 0 && passes(1) == side && passes(2) == side;
  }

  /// On which side the line of the way passes the edge.
  COLLIDE_HD int passes(int i) const {
    return sign([&](auto const& add) { sum_determinant(1, path_.to, start_.corner(i), start_.edge(i), add); });
  }

  COLLIDE_HD bool beside_corner(int i) const {
    return sign([&](auto const& add) { sum_dot(1, start_.corner(i), path_.to, add); }) > 0 &&
           sign([&](auto const& add) { sum_dot(1, end_.corner(i), path_.to, add); }) < 0;
  }

  COLLIDE_HD bool corner_within(int i) const {
    return sign([&](auto const& add) {
             sum_dot(1, path_.to, path_.to, add, start_.radius(), start_.radius());
             sum_cross_squared(-1, start_.corner(i), path_.to, add);
           }) >= 0;
  }

  COLLIDE_HD bool across_edge(int i) const {
    auto const& d = path_.to;
    auto const& e = start_.edge(i);
    auto const side = [&](auto const& v, auto const& along) {
      return sign([&](auto const& add) { sum_cross_dot_cross(1, v, along, d, e, add); });
    };
    return side(start_.corner(i), e) > 0 && side(end_.corner(i), e) < 0 && side(start_.corner(i), d) > 0 &&
           side(start_.corner((i + 1) % 3), d) < 0;
  }

  COLLIDE_HD bool edge_within(int i) const {
    auto const& d = path_.to;
    auto const& e = start_.edge(i);
    return sign([&](auto const& add) {
             sum_cross_squared(1, d, e, add, start_.radius(), start_.radius());
             sum_determinant_squared(-1, start_.corner(i), d, e, add);
           }) >= 0;
  }

  exact_path<S> path_;
  exact_triangle<> start_;
  exact_triangle<path_parts<S>> end_;
};

}  // namespace collide::detail
