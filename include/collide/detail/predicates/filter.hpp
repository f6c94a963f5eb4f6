/// \file
/// The floating-point filter of the exact predicate: decides a pair in float or double where an error bound allows it.
///
/// The closest point computed here may be wrong, and so may the feature that it lies in: the filter decides only where
/// its result holds nevertheless. Every line is proved in docs/numerics.md, for any order and any fusing of the sums,
/// and with subnormal numbers or without. On the device each operation is spelled out, so that a pair has the
/// same result in every kernel; see deferred_pairs.hpp.
#pragma once

#include <collide/detail/geometry/closest_point.hpp>

namespace collide::detail {

enum class verdict { miss = 0, hit = 1, unsure = 2 };

/// Assumptions of the filter in `T`.
template <class T>
struct certificate_bounds {
  /// Every number stays between its limits if the size of the problem (`size_of`) is between these two.
  static constexpr T smallest = T(0x1p-10), largest = T(0x1p16);
  /// Lengths are known to within this times the size.
  static constexpr T error = 32 * format<T>::unit;
  /// A squared length below this may have lost digits to underflow.
  static constexpr T shortest = T(0x1p-60);
};

/// Scales a problem with coordinates of `S` by a power of two until `certify` can work on it. False if that cannot be
/// had without losing digits.
template <class S, class Problem, class T>
COLLIDE_HD_INLINE bool brought_to_size(Problem& p, T& size) {
  using bounds = certificate_bounds<T>;
  size = size_of(p);
  if (size >= bounds::smallest && size <= bounds::largest) return true;
  // beyond, subnormal coordinates that were flushed to zero would show, or a difference has overflowed
  constexpr T floor = sizeof(S) == sizeof(float) ? T(0x1p-60) : T(0x1p-900);
  if (!(size >= floor && size <= std::numeric_limits<T>::max())) return false;
  p = scaled(p, reciprocal_power(size));
  size = size_of(p);
  return true;
}

/// Filtered test whether the triangle comes within `t.radius` of the origin. `size` is `size_of(t)`, between
/// the bounds. Coordinates may be off by `format<T>::unit` times the size. Invalid input is always uncertain.
///
/// With `Straight` there are no branches, so that a compiler makes vector code of a loop over several pairs; else it
/// stops as soon as the verdict is known.
template <bool Straight = false, class T>
COLLIDE_HD_INLINE verdict certify(local_triangle<T> const& t, T size) {
  using bounds = certificate_bounds<T>;
  vec3<T> const ab = t.b - t.a, ac = t.c - t.a;
  // The closest point as in C. Ericson, Real-Time Collision Detection, 5.1.5: its weights are v and w, as fractions.
  T const d1 = -fused_dot(ab, t.a), d2 = -fused_dot(ac, t.a), d3 = -fused_dot(ab, t.b), d4 = -fused_dot(ac, t.b),
          d5 = -fused_dot(ab, t.c), d6 = -fused_dot(ac, t.c);
  auto const minor = [](T p, T q, T r, T s) { return fused(p, q, -mul(r, s)); };
  T const va = minor(d3, d6, d5, d4), vb = minor(d5, d2, d1, d6), vc = minor(d1, d4, d3, d2);
  T v = vb, w = vc, whole = va + vb + vc;
  // decided on bits; not finite if some coordinate is not
  bool const sound = finite(whole), ball = valid_radius(t.radius), bad = !sound | !ball;
  if (!Straight && bad) return verdict::unsure;
  bool face = true;
  auto const region = [&](bool inside, T v_there, T w_there, T whole_there) {
    v = select(inside, v_there, v);
    w = select(inside, w_there, w);
    whole = select(inside, whole_there, whole);
    face = face & !inside;
  };
  region((va <= 0) & (d4 >= d3) & (d5 >= d6), d5 - d6, d4 - d3, (d4 - d3) + (d5 - d6));
  region((vb <= 0) & (d2 >= 0) & (d6 <= 0), T(0), d2, d2 - d6);
  region((vc <= 0) & (d1 >= 0) & (d3 <= 0), d1, T(0), d1 - d3);
  region((d6 >= 0) & (d5 <= d6), T(0), T(1), T(1));
  region((d3 >= 0) & (d4 <= d3), T(1), T(0), T(1));
  region((d1 <= 0) & (d2 <= 0), T(0), T(0), T(1));
  // Whatever came of that, v and w become weights: not negative, their sum not above 1.
  bool const divides = whole > std::numeric_limits<T>::min();
  T const part = select(divides, quick_reciprocal(select(divides, whole, T(1))), T(0));
  v = clamped(mul(v, part));
  T const rest = T(1) - v, limited = clamped(mul(w, part));
  w = select(limited < rest, limited, rest);
  auto const combined = [&](int k) { return t.a[k] + fused(v, ab[k], mul(w, ac[k])); };
  vec3<T> const q = {combined(0), combined(1), combined(2)};
  T const s = fused_dot(q, q);
  T const error = mul(bounds::error, size);

  T const inner = t.radius - error;
  bool const hit = (inner > 0) & (s <= mul(inner, inner));
  if (!Straight && hit) return verdict::hit;

  T const outer = t.radius + error;
  auto const beyond = [&](vec3<T> const& g, T gg) {
    T const least = smaller(smaller(fused_dot(t.a, g), fused_dot(t.b, g)), fused_dot(t.c, g));
    return (gg >= bounds::shortest) & (least > 0) & (mul(least, least) > mul(mul(outer, outer), gg));
  };
  bool miss = beyond(q, s);
  if (Straight || (face && !miss)) {  // close to the plane, its normal has a smaller relative error than q
    vec3<T> n = cross(ab, ac);
    T const sign = select(fused_dot(t.a, n) < 0, T(-1), T(1));
    n = scaled(n, sign);
    bool const above = beyond(n, fused_dot(n, n));
    miss = miss | (face & above);
  }
  // hit is 1, miss is 0
  return static_cast<verdict>(static_cast<int>(!bad & hit) | static_cast<int>(bad | !(hit | miss)) << 1);
}

}  // namespace collide::detail
