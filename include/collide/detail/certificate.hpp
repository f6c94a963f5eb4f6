/// \file
/// Verdicts that floating-point arithmetic can be sure of.
///
/// The closest point that is computed here may be wrong, and so may the region that it lies in: a verdict is only given
/// where it holds all the same. Every line is proved in docs/numerics.md, for any order and any fusing of the sums,
/// and with subnormal numbers or without.
#pragma once

#include <collide/detail/closest_point.hpp>

namespace collide::detail {

enum class verdict { miss, hit, unsure };

/// What a certificate in `T` relies on.
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

/// Whether the triangle comes within `t.radius` of the origin, where that is certain. `size` is `size_of(t)`, between
/// the bounds. Coordinates may be off by `format<T>::unit` times the size. Bad values are never certain.
template <class T>
COLLIDE_HD_INLINE verdict certify(local_triangle<T> const& t, T size) {
  using bounds = certificate_bounds<T>;
  vec3<T> const ab = t.b - t.a, ac = t.c - t.a;
  // The closest point as in C. Ericson, Real-Time Collision Detection, 5.1.5: its weights are v and w, as fractions.
  T const d1 = -ab.dot(t.a), d2 = -ac.dot(t.a), d3 = -ab.dot(t.b), d4 = -ac.dot(t.b), d5 = -ab.dot(t.c),
          d6 = -ac.dot(t.c);
  T const va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  T v = vb, w = vc, whole = va + vb + vc;
  // decided on bits; not finite if some coordinate is not
  if (!(finite(whole) & valid_radius(t.radius))) return verdict::unsure;
  bool face = true;
  auto const region = [&](bool inside, T v_there, T w_there, T whole_there) {
    v = inside ? v_there : v;
    w = inside ? w_there : w;
    whole = inside ? whole_there : whole;
    face = face & !inside;
  };
  region((va <= 0) & (d4 >= d3) & (d5 >= d6), d5 - d6, d4 - d3, (d4 - d3) + (d5 - d6));
  region((vb <= 0) & (d2 >= 0) & (d6 <= 0), T(0), d2, d2 - d6);
  region((vc <= 0) & (d1 >= 0) & (d3 <= 0), d1, T(0), d1 - d3);
  region((d6 >= 0) & (d5 <= d6), T(0), T(1), T(1));
  region((d3 >= 0) & (d4 <= d3), T(1), T(0), T(1));
  region((d1 <= 0) & (d2 <= 0), T(0), T(0), T(1));
  // Whatever came of that, v and w become weights: not negative, their sum not above 1.
  T const part = whole > std::numeric_limits<T>::min() ? quick_reciprocal(whole) : T(0);
  v = clamped(v * part);
  w = smaller(clamped(w * part), T(1) - v);
  vec3<T> const q = t.a + (v * ab + w * ac);
  T const s = q.dot(q);
  T const error = bounds::error * size;

  T const inner = t.radius - error;
  if (inner > 0 && s <= inner * inner) return verdict::hit;

  T const outer = t.radius + error;
  auto const beyond = [&](vec3<T> const& g, T gg) {
    T const least = smaller(smaller(t.a.dot(g), t.b.dot(g)), t.c.dot(g));
    return gg >= bounds::shortest && least > 0 && least * least > outer * outer * gg;
  };
  if (beyond(q, s)) return verdict::miss;
  if (face) {  // the plane's own normal is more certain than the way to a near foot
    vec3<T> n = cross(ab, ac);
    if (t.a.dot(n) < 0) n = -n;
    if (beyond(n, n.dot(n))) return verdict::miss;
  }
  return verdict::unsure;
}

}  // namespace collide::detail
