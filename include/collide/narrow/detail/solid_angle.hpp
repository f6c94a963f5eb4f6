/// \file
/// The solid angle of a triangle as seen from a point (A. van Oosterom and J. Strackee, IEEE Transactions on Biomedical
/// Engineering 30(2), 1983), and a bound of its error.
///
/// With the corners a, b and c as seen from the point, and their lengths A, B and C, half of the angle is that of
///
///     (A B C + a.b C + b.c A + c.a B,  a.(b x c))
///
/// Rounding changes each of the two by less than 80 u A B C, u = 2^-53: of a corner by u of its length, which makes
/// 3 u A B C, and of at most six products of three numbers by 11 u each. Half angles are added as complex numbers are
/// multiplied, which changes each by less than 4 u, so one angle is computed for many triangles.
#pragma once

#include <collide/exact/detail/geometry/local_triangle.hpp>
#include <collide/exact/detail/numeric/angle.hpp>

namespace collide::detail {

/// A sum of solid angles, and by how much it may be off. Complete after `settle`.
class solid_angle_sum {
 public:
  double angle = 0, error = 0;

  /// Adds that of a triangle, if it is finite, as seen from a finite point: positive where its normal points away from
  /// the point. Of a point so near to the triangle that rounding hides on which side it is, nothing, with an error of 2
  /// pi.
  template <class S>
  COLLIDE_HD void add(triangle<S> const& t, vec3<S> const& point) {
    if (!is_finite(t)) return;
    constexpr double u = ieee_traits<double>::unit_roundoff, all = 6.283185307179587;
    sphere<S> const centre{point, 0};
    local_triangle<double> const l = to_unit_range(to_local<double>(t, centre), t, centre);
    double const a = sqrt_rn(dot(l.a, l.a)), b = sqrt_rn(dot(l.b, l.b)), c = sqrt_rn(dot(l.c, l.c));
    double const product = mul_rn(mul_rn(a, b), c), across = dot(l.a, cross(l.b, l.c));
    double const along = ((product + mul_rn(dot(l.a, l.b), c)) + mul_rn(dot(l.b, l.c), a)) + mul_rn(dot(l.c, l.a), b);
    double const beside = across < 0 ? -across : across, most = max(beside, along < 0 ? -along : along);
    double const limit = mul_rn(product, 80 * u);
    if (!(most > 8 * limit && most > 0x1p-900) || (along < 0 && beside <= limit)) {
      error += all;
      return;
    }
    // as far as the point is away, the angle changes by the quotient, and by pi / 2 at most for each of the two
    error += div_rn(mul_rn(limit, 4.0), most) + 16 * u;
    double const scale = inverse_power_of_two(most);
    multiply(mul_rn(along, scale), mul_rn(across, scale));
    if (++held_ == 64) settle();
  }

  /// Adds what is not in `angle` yet.
  COLLIDE_HD void settle() {
    constexpr double u = ieee_traits<double>::unit_roundoff, half = 3.141592653589793;
    angle += mul_rn(2.0, angle_of(y_, x_) + mul_rn(2 * half, static_cast<double>(turns_)));
    error += mul_rn(2 * u, (angle < 0 ? -angle : angle) + 256);
    x_ = 1, y_ = 0, turns_ = 0, held_ = 0;
  }

 private:
  /// Turns the number that is held; both angles are from -pi to pi.
  COLLIDE_HD void multiply(double x, double y) {
    double const along = mul_rn(x_, x) - mul_rn(y_, y), across = mul_rn(x_, y) + mul_rn(y_, x);
    bool const is_wide = x_ < 0 || x < 0;
    if (is_wide && y_ >= 0 && y >= 0 && across < 0) ++turns_;
    if (is_wide && y_ < 0 && y < 0 && across >= 0) --turns_;
    x_ = along, y_ = across;
  }

  double x_ = 1, y_ = 0;      ///< half of what is not in `angle` yet is the angle of this number,
  int turns_ = 0, held_ = 0;  ///< with so many whole turns, of so many triangles
};

}  // namespace collide::detail
