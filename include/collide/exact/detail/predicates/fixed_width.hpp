/// \file
/// A sphere and a triangle in integers of fixed width: the last stage of the predicate, for numbers whose exponents are
/// not too far apart.
///
/// With the corners v_i relative to the centre, m_ik = v_i.v_k - R^2, and w_i the sum of row i of the adjugate of m,
/// the two touch if m_ii <= 0 for a corner; if m_ik < 0 and m_ii m_kk <= m_ik^2 for an edge; or if w_i > 0 for all
/// three, and det m <= 0. docs/development/numerics.md has the proof, and that nothing overflows.
#pragma once

#include <collide/exact/detail/numeric/exact_number.hpp>

namespace collide::detail {

/// Brings the next of three to the front. Loops turn what they look at, so that the device keeps it in registers and
/// has to load one copy of their instructions only: a single verdict waits for these longer than for their results.
template <class T>
COLLIDE_HD_INLINE void rotate(T (&x)[3]) {
  T const first = x[0];
  x[0] = x[1];
  x[1] = x[2];
  x[2] = first;
}

struct fixed_width_vector {
  int_words<2> component[3];
  friend COLLIDE_HD int_words<4> dot(fixed_width_vector const& p, fixed_width_vector const& q) {
    return p.component[0] * q.component[0] + p.component[1] * q.component[1] + p.component[2] * q.component[2];
  }
};

/// Finite coordinates and a finite radius, not below 0; differences of coordinates take two words of 64 bits.
class fixed_width_predicate {
 public:
  COLLIDE_HD_NOINLINE fixed_width_predicate(triangle<double> const& t, sphere<double> const& s) {
    vec3<double> const* const points[4] = {&s.centre, &t.a, &t.b, &t.c};
    // guard: fixed-unit
    lower_exponent(s.radius);
    COLLIDE_NO_UNROLL
    for (int i = 0; i < 12; ++i) lower_exponent((*points[i / 3])[i % 3]);
    radius_ = narrow(to_fixed_point(s.radius));
    COLLIDE_NO_UNROLL
    for (int i = 0; i < 9; ++i) {
      corner_[i / 3].component[i % 3] =
          narrow(to_fixed_point((*points[1 + i / 3])[i % 3]) - to_fixed_point(s.centre[i % 3]));
    }
  }

  /// True if all differences and the radius, in units of one power of two, are integers of at most
  /// 126 bits.
  COLLIDE_HD bool fits() const { return fits_; }

  /// True if the sphere touches the triangle; call it only if `fits()`.
  COLLIDE_HD_NOINLINE bool intersects() const {
    fixed_width_vector v[3] = {corner_[0], corner_[1], corner_[2]};
    int_words<4> diagonal[3] = {}, off_diagonal[3] = {};  // m_ii, and m_ik for the next corner k, of each corner i
    int_words<4> const square = radius_ * radius_;
    COLLIDE_NO_UNROLL
    for (int i = 0; i < 3; ++i) {
      diagonal[0] = dot(v[0], v[0]) - square;
      // guard: fixed-corner, fixed-touching-corner
      if (!diagonal[0].positive()) return true;
      off_diagonal[0] = dot(v[0], v[1]) - square;
      rotate(v), rotate(diagonal), rotate(off_diagonal);
    }
    COLLIDE_NO_UNROLL
    for (int i = 0; i < 3; ++i) {
      // guard: fixed-edge, fixed-touching-edge
      if (off_diagonal[0].negative() && !(diagonal[0] * diagonal[1] - off_diagonal[0] * off_diagonal[0]).positive())
        return true;
      rotate(diagonal), rotate(off_diagonal);
    }
    int_words<4> row[3] = {diagonal[0], off_diagonal[0], off_diagonal[2]};
    int_words<12> determinant{};
    COLLIDE_NO_UNROLL
    for (int i = 0; i < 3; ++i) {
      int_words<8> const weight = (diagonal[1] - off_diagonal[1]) * (diagonal[2] - off_diagonal[2]) +
                                  (off_diagonal[1] - off_diagonal[0]) * (diagonal[2] - off_diagonal[1]);
      // guard: fixed-face, fixed-degenerate
      if (!weight.positive()) return false;
      determinant = determinant + row[0] * weight;
      rotate(row), rotate(diagonal), rotate(off_diagonal);
    }
    // guard: fixed-touching-face
    return !determinant.positive();
  }

 private:
  static constexpr int max_bits = 126;
  // guard: fixed-shift
  static constexpr int max_length = 126;  ///< of a number: a bit of two words is for differences, one for the sign

  int exponent_ = 1 << 30;  ///< as a power of two
  bool fits_ = true;
  int_words<2> radius_;
  fixed_width_vector corner_[3] = {};  ///< relative to the centre

  COLLIDE_HD void lower_exponent(double x) {
    dyadic const d = decoded(x);
    if (d.mantissa != 0) exponent_ = min(exponent_, d.exponent);
  }

  COLLIDE_HD uint128 to_fixed_point(double x) {
    dyadic const d = decoded(x);
    if (d.mantissa == 0) return 0;
    int const shift = d.exponent - exponent_;
    // guard: fixed-far
    fits_ = fits_ && shift + d.length() <= max_length;
    return static_cast<uint128>(d.mantissa) << (shift & 127);
  }

  COLLIDE_HD int_words<2> narrow(uint128 x) {
    constexpr uint128 limit = uint128{1} << max_bits;
    fits_ = fits_ && x + limit <= 2 * limit;  // from -limit to limit
    return {{static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(x >> 64)}};
  }
};

}  // namespace collide::detail
