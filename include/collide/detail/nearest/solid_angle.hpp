/// \file
/// The solid angle of a triangle as seen from a point (A. van Oosterom and J. Strackee, IEEE Transactions on Biomedical
/// Engineering 30(2), 1983), and a bound of its error.
///
/// With the corners a, b and c as seen from the point, and their lengths A, B and C, half of the angle is that of
///
///     (A B C + a.b C + b.c A + c.a B,  a.(b x c))
///
/// Rounding changes each of the two by less than 80 u A B C, u = 2^-53: of a corner by u of its length, which makes
/// 3 u A B C, and of at most six products of three numbers by 11 u each.
#pragma once

#include <collide/detail/geometry/local_triangle.hpp>
#include <collide/detail/numeric/angle.hpp>

namespace collide::detail {

/// A sum of solid angles, and by how much it may be off.
struct solid_angle_sum {
  double angle = 0, error = 0;

  /// Adds that of a finite triangle as seen from a finite point: positive where its normal points away from the point.
  template <class S>
  COLLIDE_HD void add(triangle<S> const& t, vec3<S> const& point) {
    constexpr double u = ieee_traits<double>::unit_roundoff, all = 6.283185307179587;
    sphere<S> const centre{point, 0};
    local_triangle<double> const l = to_unit_range(to_local<double>(t, centre), t, centre);
    double const a = sqrt_rn(dot(l.a, l.a)), b = sqrt_rn(dot(l.b, l.b)), c = sqrt_rn(dot(l.c, l.c));
    double const product = mul_rn(mul_rn(a, b), c), across = dot(l.a, cross(l.b, l.c));
    double const along = ((product + mul_rn(dot(l.a, l.b), c)) + mul_rn(dot(l.b, l.c), a)) + mul_rn(dot(l.c, l.a), b);
    double const most = max(across < 0 ? -across : across, along < 0 ? -along : along);
    double const limit = mul_rn(product, 80 * u);
    // as far as the point is away, the angle changes by the quotient, and by pi / 2 at most for each of the two
    double const off = most > 8 * limit && most > 0x1p-900 ? div_rn(mul_rn(limit, 4.0), most) + 8 * u : all;
    double const there = mul_rn(2.0, angle_of(across, along));
    angle += there;
    error += min(off, all) + mul_rn(2 * u, (angle < 0 ? -angle : angle) + 8);
  }
};

}  // namespace collide::detail
