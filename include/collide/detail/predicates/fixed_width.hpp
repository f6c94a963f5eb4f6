/// \file
/// A sphere and a triangle in integers of fixed width: the last stage of the predicate, for numbers whose exponents are
/// not too far apart.
///
/// With the corners v_i relative to the centre, and weights x_i that sum to 1, the point that has these weights is
/// within the radius R if and only if the sum of all x_i x_k m_ik is not above 0, where
///
///     m_ik = v_i.v_k - R^2
///
/// So a corner is in reach if m_ii <= 0. If no corner is, an edge is, at the foot of the perpendicular, if
///
///     m_ik < 0  and  m_ii m_kk <= m_ik^2
///
/// and the face is, at its foot, whose weights are proportional to w_i, if
///
///     w_i > 0 for all three  and  det m <= 0
///
/// where w_i is the sum of row i of the adjugate of m, and so m w = (det m, det m, det m). docs/numerics.md has the
/// proof, and that nothing overflows.
#pragma once

#include <collide/detail/numeric/exact_number.hpp>
#include <collide/detail/numeric/wide_int.hpp>

namespace collide::detail {

/// Brings the next of three to the front. Loops turn what they look at, so that the device keeps it in registers and
/// has to load one copy of their instructions only: a single verdict waits for these longer than for their results.
template <class T>
COLLIDE_HD_INLINE void turn(T (&x)[3]) {
  T const first = x[0];
  x[0] = x[1];
  x[1] = x[2];
  x[2] = first;
}

/// Finite coordinates and a finite radius, not below 0; differences of coordinates take two words of 64 bits.
class fixed_triangle {
 public:
  COLLIDE_HD_NOINLINE fixed_triangle(triangle<double> const& t, sphere<double> const& s) {
    vec3<double> const* const points[4] = {&s.centre, &t.a, &t.b, &t.c};
    extend_unit(s.radius);
    COLLIDE_ROLLED
    for (int i = 0; i < 12; ++i) extend_unit((*points[i / 3])[i % 3]);
    radius_ = fitted(in_units(s.radius));
    COLLIDE_ROLLED
    for (int i = 0; i < 9; ++i) {
      corner_[i / 3].component[i % 3] = fitted(in_units((*points[1 + i / 3])[i % 3]) - in_units(s.centre[i % 3]));
    }
  }

  /// True if all differences and the radius, in units of one power of two, are integers of at most
  /// 126 bits.
  COLLIDE_HD bool holds() const { return holds_; }

  /// True if the sphere touches the triangle; call it only if `holds()`.
  COLLIDE_HD_NOINLINE bool in_reach() const {
    vector v[3] = {corner_[0], corner_[1], corner_[2]};
    wide<4> own[3] = {}, next[3] = {};  // m_ii, and m_ik for the next corner k, of each corner i
    wide<4> const square = radius_ * radius_;
    COLLIDE_ROLLED
    for (int i = 0; i < 3; ++i) {
      own[0] = dot(v[0], v[0]) - square;
      if (!own[0].positive()) return true;
      next[0] = dot(v[0], v[1]) - square;
      turn(v), turn(own), turn(next);
    }
    COLLIDE_ROLLED
    for (int i = 0; i < 3; ++i) {
      if (next[0].negative() && !(own[0] * own[1] - next[0] * next[0]).positive()) return true;
      turn(own), turn(next);
    }
    wide<4> row[3] = {own[0], next[0], next[2]};
    wide<12> determinant{};
    COLLIDE_ROLLED
    for (int i = 0; i < 3; ++i) {
      wide<8> const weight = (own[1] - next[1]) * (own[2] - next[2]) + (next[1] - next[0]) * (own[2] - next[1]);
      if (!weight.positive()) return false;
      determinant = determinant + row[0] * weight;
      turn(row), turn(own), turn(next);
    }
    return !determinant.positive();
  }

 private:
  struct vector {
    wide<2> component[3];
  };

  static constexpr int most_bits = 126;
  static constexpr int most_length = 126;  ///< of a number: a bit of two words is for differences, one for the sign

  int unit_ = 1 << 30;  ///< as a power of two
  bool holds_ = true;
  wide<2> radius_;
  vector corner_[3] = {};  ///< relative to the centre

  COLLIDE_HD void extend_unit(double x) {
    dyadic const d = decoded(x);
    if (d.mantissa != 0) unit_ = smaller(unit_, d.exponent);
  }

  COLLIDE_HD two_words in_units(double x) {
    dyadic const d = decoded(x);
    if (d.mantissa == 0) return 0;
    int const shift = d.exponent - unit_;
    holds_ = holds_ && shift + d.length() <= most_length;
    return static_cast<two_words>(d.mantissa) << (shift & 127);
  }

  COLLIDE_HD wide<2> fitted(two_words x) {
    constexpr two_words most = two_words{1} << most_bits;
    holds_ = holds_ && x + most <= 2 * most;  // from -most to most
    return {{static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(x >> 64)}};
  }

  static COLLIDE_HD wide<4> dot(vector const& p, vector const& q) {
    return p.component[0] * q.component[0] + p.component[1] * q.component[1] + p.component[2] * q.component[2];
  }
};

}  // namespace collide::detail
