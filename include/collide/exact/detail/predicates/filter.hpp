/// \file
/// The floating-point filter of the exact predicate: decides a pair in float or double where an error bound allows it.
///
/// The closest point computed here may be wrong, and so may the feature that it lies in: the filter decides only where
/// its result holds nevertheless. Every line is proved in docs/development/numerics.md, for any order and any fusing of
/// the sums, and with subnormal numbers or without. On the device each operation is spelled out, so that a pair has the
/// same result in every kernel; see deferred_pairs.hpp.
#pragma once

#include <collide/exact/detail/geometry/closest_point.hpp>

namespace collide::detail {

/// Verdict of a filter: `uncertain` is left to more digits; `out_of_range`, of a filter without branches, to one that
/// rescales the coordinates.
enum class verdict { miss = 0, hit = 1, uncertain = 2, out_of_range = 3 };

/// Assumptions of the filter in `T`.
template <class T>
struct filter_bounds {
  /// Every number stays between its limits if the size of the problem (`max_norm`) is between these two.
  static constexpr T smallest = T(0x1p-10), largest = T(0x1p16);
  /// Lengths are known to within this times the size.
  // guard: error
  static constexpr T error = 32 * ieee_traits<T>::unit_roundoff;
  /// A squared length below this may have lost digits to underflow.
  static constexpr T shortest = T(0x1p-60);
};

/// Scales a problem with coordinates of `S` by a power of two until `filtered_test` can work on it. False if that
/// cannot be had without losing digits.
template <class S, class Problem, class T>
COLLIDE_HD_INLINE bool rescale_to_filter_range(Problem& p, T& size) {
  using bounds = filter_bounds<T>;
  size = max_norm(p);
  // guard: smallest, largest
  if (size >= bounds::smallest && size <= bounds::largest) return true;
  // beyond, subnormal coordinates that were flushed to zero would show, or a difference has overflowed
  // guard: floor-of-float, floor-of-double
  constexpr T floor = sizeof(S) == sizeof(float) ? T(0x1p-60) : T(0x1p-900);
  if (!(size >= floor && size <= std::numeric_limits<T>::max())) return false;
  // guard: scaling
  p = scaled(p, inverse_power_of_two(size));
  size = max_norm(p);
  return true;
}

/// Filtered test whether the triangle comes within `t.radius` of the origin. `size` is `max_norm(t)`, between
/// the bounds. Coordinates may be off by `ieee_traits<T>::unit_roundoff` times the size. Invalid input is always
/// uncertain.
///
/// With `Branchless` there are no branches, so that a compiler makes vector code of a loop over several pairs; else it
/// stops as soon as the verdict is known.
template <bool Branchless = false, class T>
COLLIDE_HD_INLINE verdict filtered_test(local_triangle<T> const& t, T size) {
  using bounds = filter_bounds<T>;
  vec3<T> const ab = t.b - t.a, ac = t.c - t.a;
  // The closest point as in C. Ericson, Real-Time Collision Detection, 5.1.5: its weights are v and w, as fractions.
  T const d1 = -dot_mul_add(ab, t.a), d2 = -dot_mul_add(ac, t.a), d3 = -dot_mul_add(ab, t.b),
          d4 = -dot_mul_add(ac, t.b), d5 = -dot_mul_add(ab, t.c), d6 = -dot_mul_add(ac, t.c);
  auto const minor = [](T p, T q, T r, T s) { return mul_add(p, q, -mul_rn(r, s)); };
  T const va = minor(d3, d6, d5, d4), vb = minor(d5, d2, d1, d6), vc = minor(d1, d4, d3, d2);
  T v = vb, w = vc, weight_sum = va + vb + vc;
  // decided on bits; not finite if some coordinate is not
  bool const sound = is_finite(weight_sum), has_radius = is_valid_radius(t.radius), bad = !sound | !has_radius;
  if (!Branchless && bad) return verdict::uncertain;
  bool face = true;
  auto const select_region = [&](bool inside, T v_there, T w_there, T weight_sum_there) {
    // guard: regions
    v = select(inside, v_there, v);
    w = select(inside, w_there, w);
    weight_sum = select(inside, weight_sum_there, weight_sum);
    face = face & !inside;
  };
  select_region((va <= 0) & (d4 >= d3) & (d5 >= d6), d5 - d6, d4 - d3, (d4 - d3) + (d5 - d6));
  select_region((vb <= 0) & (d2 >= 0) & (d6 <= 0), T(0), d2, d2 - d6);
  select_region((vc <= 0) & (d1 >= 0) & (d3 <= 0), d1, T(0), d1 - d3);
  select_region((d6 >= 0) & (d5 <= d6), T(0), T(1), T(1));
  select_region((d3 >= 0) & (d4 <= d3), T(1), T(0), T(1));
  select_region((d1 <= 0) & (d2 <= 0), T(0), T(0), T(1));
  // Whatever came of that, v and w become weights: not negative, their sum not above 1.
  bool const divides = weight_sum > std::numeric_limits<T>::min();
  T const inverse = select(divides, approx_reciprocal(select(divides, weight_sum, T(1))), T(0));
  // guard: v-from-below, v-from-above
  v = saturate(mul_rn(v, inverse));
  // guard: w-from-below
  T const remainder = T(1) - v, limited = saturate(mul_rn(w, inverse));
  // guard: v-and-w
  w = select(limited < remainder, limited, remainder);
  auto const combined = [&](int k) { return t.a[k] + mul_add(v, ab[k], mul_rn(w, ac[k])); };
  vec3<T> const q = {combined(0), combined(1), combined(2)};
  T const s = dot_mul_add(q, q);
  T const error = mul_rn(bounds::error, size);

  // guard: error-of-hit
  T const radius_low = t.radius - error;
  // guard: inner
  bool const hit = (radius_low > 0) & (s <= mul_rn(radius_low, radius_low));
  if (!Branchless && hit) return verdict::hit;

  // guard: error-of-miss
  T const radius_high = t.radius + error;
  auto const is_separating = [&](vec3<T> const& g, T gg) {
    T const lowest = min(min(dot_mul_add(t.a, g), dot_mul_add(t.b, g)), dot_mul_add(t.c, g));
    // guard: least, shortest
    return (gg >= bounds::shortest) & (lowest > 0) &
           (mul_rn(lowest, lowest) > mul_rn(mul_rn(radius_high, radius_high), gg));
  };
  bool miss = is_separating(q, s);
  if (Branchless || (face && !miss)) {  // close to the plane, its normal has a smaller relative error than q
    vec3<T> n = cross(ab, ac);
    T const sign = select(dot_mul_add(t.a, n) < 0, T(-1), T(1));
    n = scaled(n, sign);
    bool const above = is_separating(n, dot_mul_add(n, n));
    miss = miss | (face & above);
  }
  // hit is 1, miss is 0
  return static_cast<verdict>(static_cast<int>(!bad & hit) | static_cast<int>(bad | !(hit | miss)) << 1);
}

}  // namespace collide::detail
