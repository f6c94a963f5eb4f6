/// \file
/// Triangles as they look from far away: moments of their normals, the solid angle that these give, and how far it is
/// off (G. Barill et al., "Fast winding numbers for soups and clouds", ACM Transactions on Graphics 37(4), 2018).
///
/// With r from a point to the centre, R = |r|, and x from the centre to the triangles, their solid angle is the
/// integral of n . F(r + x), where F(v) = v / |v|^3. The term of F of degree k in x is the gradient of a solid harmonic
/// of degree k + 1, so by the inequality of Bernstein and Szego at most (k + 1) |x|^k / R^(k + 2). Those from degree 3
/// on are left out: with |x| at most t R they make
///
///     |x|^3 (4 - 3 t) / (R^5 (1 - t)^2)
///
/// at most, and |x|^3 at most t R |x|^2. Rounding changes a moment of degree k by less than 2^-43 times `edges` and the
/// k-th power of the radius, in at most 12 levels.
#pragma once

#include <collide/exact/detail/geometry/local_triangle.hpp>
#include <collide/exact/detail/numeric/elementary.hpp>

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
    double const beside = across < 0 ? -across : across, larger = max(beside, along < 0 ? -along : along);
    double const limit = mul_rn(product, 80 * u);
    if (!(larger > 8 * limit && larger > 0x1p-900) || (along < 0 && beside <= limit)) {
      error += all;
      return;
    }
    // as far as the point is away, the angle changes by the quotient, and by pi / 2 at most for each of the two
    error += div_rn(mul_rn(limit, 4.0), larger) + 16 * u;
    double const scale = inverse_power_of_two(larger);
    multiply(mul_rn(along, scale), mul_rn(across, scale));
    if (++count_ == 64) settle();
  }

  /// Adds what is not in `angle` yet.
  COLLIDE_HD void settle() {
    constexpr double u = ieee_traits<double>::unit_roundoff, half = 3.141592653589793;
    angle += mul_rn(2.0, angle_of(y_, x_) + mul_rn(2 * half, static_cast<double>(turns_)));
    error += mul_rn(2 * u, (angle < 0 ? -angle : angle) + 256);
    x_ = 1, y_ = 0, turns_ = 0, count_ = 0;
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

  double x_ = 1, y_ = 0;       ///< half of what is not in `angle` yet is the angle of this number,
  int turns_ = 0, count_ = 0;  ///< with so many whole turns, of so many triangles
};

/// Moments of the normals of some triangles about a centre. Coordinates are scaled to at most 2.
struct normal_moments {
  vec3<double> centre{0, 0, 0};
  vec3<double> normal{0, 0, 0};           ///< the integral of n,
  double second[6] = {}, third[10] = {};  ///< of n x and of n x x, symmetric: xx, xy, xz, yy, ..., xxx, xxy, xxz, ...
  double radius = 0;                      ///< of a sphere around the centre that they are in, at least
  double area = 0, squares = 0;           ///< the integral of 1 and of |x|^2, about
  double edges = 0;                       ///< the sum of the products of two edges of each
  vec3<double> lower{0, 0, 0}, upper{0, 0, 0};  ///< their box

  COLLIDE_HD static normal_moments of(triangle<double> const& t) {
    normal_moments m;
    vec3<double> const u = t.b - t.a, v = t.c - t.a;
    m.centre = t.a + scaled(vec3<double>(u + v), one_third);
    vec3<double> const corners[3] = {t.a - m.centre, t.b - m.centre, t.c - m.centre};
    vec3<double> const middle = scaled(corners[0] + corners[1] + corners[2], one_third);  // the rounding of the centre
    m.normal = scaled(cross(u, v), 0.5);
    m.area = sqrt_rn(dot(m.normal, m.normal));
    m.lower = min(min(t.a, t.b), t.c);
    m.upper = max(max(t.a, t.b), t.c);
    m.edges = sqrt_rn(mul_rn(dot(u, u), dot(v, v)));
    double spread[6], largest = 0;
    for (vec3<double> const& c : corners) largest = max(largest, dot(c, c));
    for (int i = 0, n = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j, ++n) {
        double sum = mul_rn(9.0, mul_rn(middle[i], middle[j]));
        for (vec3<double> const& c : corners) sum += mul_rn(c[i], c[j]);
        spread[n] = mul_rn(sum, 1.0 / 12);
        m.second[n] = mul_rn(0.5, mul_rn(m.normal[i], middle[j]) + mul_rn(m.normal[j], middle[i]));
      }
    }
    m.squares = mul_rn(m.area, largest);
    m.radius = mul_rn(sqrt_rn(largest), wider);
    m.add_products(spread, m.normal, one_third);
    return m;
  }

  /// Adds other triangles, about the centre of these.
  COLLIDE_HD void add(normal_moments const& other) {
    vec3<double> const away = other.centre - centre;
    double const squared = dot(away, away), far = sqrt_rn(squared);
    normal += other.normal;
    area += other.area;
    edges += other.edges;
    squares += other.squares + mul_rn(other.area, squared + mul_rn(far, 0x1p-46));  // its centre is rounded
    radius = max(radius, mul_rn(far + other.radius, wider));
    lower = min(lower, other.lower);
    upper = max(upper, other.upper);
    double products[6];
    for (int i = 0, n = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j, ++n) {
        products[n] = mul_rn(away[i], away[j]);
        second[n] += other.second[n] + mul_rn(0.5, mul_rn(other.normal[i], away[j]) + mul_rn(other.normal[j], away[i]));
      }
    }
    for (int n = 0; n < 10; ++n) third[n] += other.third[n];
    add_products(products, other.normal, one_third);
    add_products(other.second, away, 2 * one_third);
  }

  /// Lets the box tell of the radius, where that is less.
  COLLIDE_HD void limit_radius() {
    vec3<double> const far = max(vec3<double>(upper - centre), vec3<double>(centre - lower));
    radius = min(radius, mul_rn(sqrt_rn(dot(far, far)), wider));
  }

  /// True if they are so far from a point that it can be seen how far their solid angle is off.
  COLLIDE_HD bool is_far(vec3<double> const& point, double beta) const {
    vec3<double> const r = centre - point;
    double const reach = mul_rn(radius, beta);
    return radius > 0x1p-120 && dot(r, r) > mul_rn(reach, reach);
  }

  /// Adds their solid angle as seen from a point that is far.
  COLLIDE_HD void add_to(solid_angle_sum& sum, vec3<double> const& point) const {
    vec3<double> const r = centre - point;
    double const inverse = div_rn(1.0, sqrt_rn(dot(r, r))), square = mul_rn(inverse, inverse);
    vec3<double> const e = scaled(r, inverse);
    constexpr int at[6][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}, {3, 6, 7}, {4, 7, 8}, {5, 8, 9}};
    double along[6];  // the third moment times e
    for (int n = 0; n < 6; ++n) along[n] = dot(vec3<double>(third[at[n][0]], third[at[n][1]], third[at[n][2]]), e);
    double const next = trace(second) - mul_rn(3.0, twice(second, e));
    double const last = mul_rn(7.5, twice(along, e)) - mul_rn(4.5, trace(along));
    sum.angle += mul_rn(square, dot(normal, e) + mul_rn(inverse, next + mul_rn(inverse, last)));
    double const t = mul_rn(mul_rn(radius, inverse), wider), rest = 1 - t;
    double const left_out = mul_rn(mul_rn(squares, mul_rn(t, square)), 4 - mul_rn(3.0, t));
    sum.error += div_rn(mul_rn(square, left_out + mul_rn(edges, 0x1p-34)), mul_rn(rest, rest)) +
                 mul_rn(0x1p-52, sum.angle < 0 ? -sum.angle : sum.angle);
  }

 private:
  static constexpr double one_third = 1.0 / 3, wider = 1 + 0x1p-40;

  static COLLIDE_HD double trace(double const (&m)[6]) { return m[0] + m[3] + m[5]; }

  /// e . m e
  static COLLIDE_HD double twice(double const (&m)[6], vec3<double> const& e) {
    vec3<double> const me(dot({m[0], m[1], m[2]}, e), dot({m[1], m[3], m[4]}, e), dot({m[2], m[4], m[5]}, e));
    return dot(me, e);
  }

  /// Adds `part` times v_i m_jk + v_j m_ik + v_k m_ij to the third moment.
  COLLIDE_HD void add_products(double const (&m)[6], vec3<double> const& v, double weight) {
    constexpr int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int i = 0, n = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) {
        for (int k = j; k < 3; ++k, ++n) {
          double const sum = mul_rn(v[i], m[at[j][k]]) + mul_rn(v[j], m[at[i][k]]) + mul_rn(v[k], m[at[i][j]]);
          third[n] += mul_rn(weight, sum);
        }
      }
    }
  }
};

}  // namespace collide::detail
