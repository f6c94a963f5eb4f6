/// \file
/// The distance of a point from a triangle in integers of fixed width, for numbers whose exponents are not too far
/// apart: its projection, and the square of the distance as a quotient.
///
/// With the corners v_i relative to the point, all is told by the products g_ik = v_i.v_k:
///
///                closest if                                       squared distance
///     corner i   g_ij >= g_ii and g_ik >= g_ii                    g_ii
///     edge ij    g_ij < g_ii, g_ij < g_jj and w_k <= 0            (g_ii g_jj - g_ij^2) / (g_ii + g_jj - 2 g_ij)
///     face       w_i > 0 for all three                            det g / (w_i + w_j + w_k)
///
/// where w_i is the sum of row i of the adjugate of g: proportional to the weight of corner i at the projection of the
/// perpendicular. What is on a line or a point has no w_i but 0, so edges and corners decide.
#pragma once

#include <collide/exact/detail/predicates/fixed_width.hpp>

namespace collide::detail {

/// Points and triangles as integers in units of one power of two.
class fixed_width_units {
 public:
  // guard: nearest-fit
  static constexpr int max_bits = 124;  ///< of a difference

  COLLIDE_HD void include(vec3<double> const& point) {
    COLLIDE_NO_UNROLL
    for (int k = 0; k < 3; ++k) {
      dyadic const d = decoded(point[k]);
      if (d.mantissa == 0) continue;
      exponent_ = min(exponent_, d.exponent);
      top_ = max(top_, d.exponent + d.length());
    }
  }
  COLLIDE_HD void include(triangle<double> const& t) {
    include(t.a);
    include(t.b);
    include(t.c);
  }

  /// True if differences of all that was included are integers of at most `max_bits` bits.
  COLLIDE_HD bool fit() const { return top_ - exponent_ < max_bits; }

  /// to - from, if all fit.
  COLLIDE_HD int_words<2> difference(double to, double from) const {
    uint128 const x = fixed(to) - fixed(from);
    return {{static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(x >> 64)}};
  }

 private:
  int exponent_ = 1 << 30, top_ = -(1 << 30);  ///< of the lowest bit, and above the highest

  COLLIDE_HD uint128 fixed(double x) const {
    dyadic const d = decoded(x);
    return d.mantissa == 0 ? 0 : static_cast<uint128>(d.mantissa) << ((d.exponent - exponent_) & 127);
  }
};

/// A finite triangle as seen from a finite point.
class fixed_width_distance {
 public:
  /// Call it only if all `fit()`.
  COLLIDE_HD_NOINLINE fixed_width_distance(fixed_width_units const& units, triangle<double> const& t,
                                           vec3<double> const& point) {
    fixed_width_vector v[3];
    COLLIDE_NO_UNROLL
    for (int i = 0; i < 9; ++i) {
      vec3<double> const& corner = i < 3 ? t.a : (i < 6 ? t.b : t.c);
      v[i / 3].component[i % 3] = units.difference(corner[i % 3], point[i % 3]);
    }
    int_words<4> diagonal[3] = {}, off_diagonal[3] = {};  // g_ii, and g_ik for the next corner k, of each corner i
    COLLIDE_NO_UNROLL
    for (int i = 0; i < 3; ++i) {
      diagonal[0] = dot(v[0], v[0]);
      off_diagonal[0] = dot(v[0], v[1]);
      rotate(v), rotate(diagonal), rotate(off_diagonal);
    }
    int_words<8> weight[3] = {};
    COLLIDE_NO_UNROLL
    for (int i = 0; i < 3; ++i) {
      weight[0] = (diagonal[1] - off_diagonal[1]) * (diagonal[2] - off_diagonal[2]) +
                  (off_diagonal[1] - off_diagonal[0]) * (diagonal[2] - off_diagonal[1]);
      rotate(weight), rotate(diagonal), rotate(off_diagonal);
    }
    // guard: nearest-face
    if (weight[0].positive() && weight[1].positive() && weight[2].positive()) {
      foot_ = 6;
      square_ = diagonal[0] * weight[0] + off_diagonal[0] * weight[1] + off_diagonal[2] * weight[2];
      length_ = weight[0] + weight[1] + weight[2];
      return;
    }
    COLLIDE_NO_UNROLL
    for (int i = 0; i < 3; ++i) {
      int_words<4> const before = diagonal[0] - off_diagonal[0], after = diagonal[1] - off_diagonal[0];
      // guard: nearest-edge-begin, nearest-edge-end, nearest-edge-side
      if (before.positive() && after.positive() && !weight[2].positive()) {
        foot_ = 3 + i;
        square_ = extended<12>(diagonal[0] * diagonal[1] - off_diagonal[0] * off_diagonal[0]);
        length_ = extended<8>(before + after);
        return;
      }
      rotate(weight), rotate(diagonal), rotate(off_diagonal);
    }
    length_ = extended<8>(int_words<4>{{1}});
    COLLIDE_NO_UNROLL
    for (foot_ = 0; foot_ < 2; ++foot_) {
      if (!(diagonal[0] - off_diagonal[0]).positive() && !(diagonal[0] - off_diagonal[2]).positive()) break;
      rotate(diagonal), rotate(off_diagonal);
    }
    square_ = extended<12>(diagonal[0]);
  }

  /// The projection of the point: corners 0, 1 and 2, edges 3, 4 and 5, the face 6.
  COLLIDE_HD int projection() const { return foot_; }

  /// -1 if s is nearer than t, 0 if both are as near, else 1. Both are in the same units.
  static COLLIDE_HD_NOINLINE int compare(fixed_width_distance const& s, fixed_width_distance const& t) {
    int_words<20> const difference = s.square_ * t.length_ - t.square_ * s.length_;
    return difference.negative() ? -1 : (difference.positive() ? 1 : 0);
  }

 private:
  int foot_ = 0;
  int_words<12> square_{};  ///< of the distance, times `length_`
  int_words<8> length_{};   ///< not 0

  /// A number that is not negative, in more words.
  template <int N, int M>
  static COLLIDE_HD int_words<N> extended(int_words<M> const& x) {
    int_words<N> longer{};
    for (int i = 0; i < M; ++i) longer.word[i] = x.word[i];
    return longer;
  }
};

}  // namespace collide::detail
