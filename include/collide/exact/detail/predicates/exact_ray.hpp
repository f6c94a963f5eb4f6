/// \file
/// The test if the ray from a point along +z crosses a triangle, exactly, with every touch of an edge or corner decided
/// one way: simulation of simplicity (H. Edelsbrunner and E. P. Mücke, ACM Transactions on Graphics 9(1), 1990).
///
/// The point is moved by (e, e^2, 0) for an e that is smaller than any number. Then the ray meets no edge, and of the
/// triangles around an edge or a corner it crosses as many as it must. It depends on coordinates alone, so triangles
/// need not know that they share a corner.
#pragma once

#include <cstdint>

#include <collide/exact/detail/numeric/exact_sum.hpp>
#include <collide/exact/detail/predicates/exact.hpp>

namespace collide::detail {

/// The place where the ray crosses a triangle: nowhere, above its beginning, or there.
enum class ray_crossing { none, above, at_point };

/// Decides as `cross_ray` does, in doubles, unless the ray passes near an edge or begins near the triangle: false then.
/// With M the largest coordinate of a corner as seen from the point, corners have an error of u M, sides one below
/// 16 u M^2, and the height, a sum of sides times coordinates, one below 128 u M^3.
template <class S>
COLLIDE_HD_INLINE bool cross_ray_in_double(triangle<S> const& t, vec3<S> const& p, ray_crossing& crossing) {
  constexpr double u = ieee_traits<double>::unit_roundoff, smallest = 0x1p-70;  // subnormal numbers may be flushed
  vec3<double> const a = difference_in_double(t.a, p), b = difference_in_double(t.b, p),
                     c = difference_in_double(t.c, p);
  double const size = max(max(max_norm(a), max_norm(b)), max_norm(c));
  auto const side = [](vec3<double> const& v, vec3<double> const& w) {
    return mul_rn(v.x(), w.y()) - mul_rn(v.y(), w.x());
  };
  double const ab = side(a, b), bc = side(b, c), ca = side(c, a), least = min(min(ab, bc), ca),
               most = max(max(ab, bc), ca), area = mul_rn(size, size);
  if (!(size >= smallest && size <= 0x1p140)) return false;
  // guard: ray-sides
  double const error = mul_rn(16 * u, area);
  crossing = ray_crossing::none;
  if (least < -error && most > error) return true;
  if (!(least > error || most < -error)) return false;
  double const height = mul_rn(bc, a.z()) + mul_rn(ca, b.z()) + mul_rn(ab, c.z()), along = least > 0 ? height : -height;
  // guard: ray-along
  double const height_error = mul_rn(128 * u, mul_rn(area, size));
  if (along > height_error) crossing = ray_crossing::above;
  return along > height_error || along < -height_error;
}

/// Decides in the type of the coordinates and without a branch, for lanes of a host's vector unit: 1 if the ray from
/// (x, y, z) crosses the triangle above its beginning, 0 if it does not, -1 if that is not decided. Errors are as
/// there, with M the largest coordinate across the ray and N along it: of sides 16 u M^2, of the height 128 u M^2 N.
template <class S>
std::int32_t cross_ray_in_lane(triangle<S> const& t, S x, S y, S z) {
  constexpr S u = ieee_traits<S>::unit_roundoff;
  constexpr bool is_float = sizeof(S) == sizeof(float);
  constexpr S smallest = is_float ? S(0x1p-30) : S(0x1p-70), largest = is_float ? S(0x1p40) : S(0x1p140);
  S const ax = t.a[0] - x, ay = t.a[1] - y, az = t.a[2] - z, bx = t.b[0] - x, by = t.b[1] - y, bz = t.b[2] - z,
          cx = t.c[0] - x, cy = t.c[1] - y, cz = t.c[2] - z;
  auto const larger = [](auto p, auto q) { return select(p > q, p, q); };
  auto const size = [](S p) { return to_bits(p) & ~ieee_traits<S>::sign_mask; };  // NaN and infinity sort last
  auto const across =
      larger(larger(larger(size(ax), size(ay)), larger(size(bx), size(by))), larger(size(cx), size(cy)));
  auto const along = larger(larger(size(az), size(bz)), size(cz));
  auto const is_usual = [](auto bits) { return bits - to_bits(smallest) <= to_bits(largest) - to_bits(smallest); };
  S const ab = ax * by - ay * bx, bc = bx * cy - by * cx, ca = cx * ay - cy * ax, sum = bc * az + ca * bz + ab * cz;
  S const least = -larger(larger(-ab, -bc), -ca), most = larger(larger(ab, bc), ca);
  S const width = from_bits<S>(across), area = width * width, height = select(least > 0, sum, -sum);
  // guard: lane-sides, lane-along
  S const error = 16 * u * area, height_error = 128 * u * area * from_bits<S>(along);
  bool const beside = (least < -error) & (most > error), within = (least > error) | (most < -error);
  bool const above = within & (height > height_error), below = within & (height < -height_error);
  int const usual = int{is_usual(across)} & int{is_usual(along)};
  return select(usual != 0, select(above, 1, select(beside | below, 0, -1)), -1);
}

COLLIDE_HD inline int sign_of(double x) { return x < 0 ? -1 : (x > 0 ? 1 : 0); }

/// The sign of (b - a) x (d - c), each component a difference of finite doubles: exactly.
COLLIDE_HD_NOINLINE inline int sign_of_cross_in_integers(double const (&to)[4], double const (&from)[4]) {
  exact_memory<8, 4> memory;
  exact_numbers numbers = memory.table();
  for (int i = 0; i < 4; ++i) {
    numbers.begin_number();
    numbers.add(decoded(to[i]));
    numbers.subtract(decoded(from[i]));
  }
  exact_products sum;
  sum.add(1, 0, 3);
  sum.add(-1, 1, 2);
  return exact_sum::sign_of(numbers, sum);
}

/// On which side of the line from a to b the point p is, as seen from +z: 1 if it is to the left, 0 on the line.
COLLIDE_HD_INLINE int side_of_line(vec3<double> const& a, vec3<double> const& b, vec3<double> const& p) {
  double const x = b.x() - a.x(), y = b.y() - a.y(), u = p.x() - a.x(), v = p.y() - a.y();
  // the sign of a difference is exact
  int const first = sign_of(x) * sign_of(v), second = sign_of(y) * sign_of(u);
  if (first != second) return first > second ? 1 : -1;
  if (first == 0) return 0;
  double const p1 = mul_rn(x, v), p2 = mul_rn(y, u), difference = p1 - p2, sum = max(p1, -p1) + max(p2, -p2);
  // guard: ray-side
  double const error = mul_rn(sum, 8 * ieee_traits<double>::unit_roundoff);
  if (sum > 0x1p-900 && sum < 0x1p1000 && (difference > error || difference < -error)) return sign_of(difference);
  return sign_of_cross_in_integers({b.x(), b.y(), p.x(), p.y()}, {a.x(), a.y(), a.x(), a.y()});
}

/// The side once p is moved; 0 only if a and b have the same x and y.
COLLIDE_HD_INLINE int side_of_line_moved(int side, vec3<double> const& a, vec3<double> const& b) {
  if (side != 0) return side;
  // guard: ray-moved, ray-moved-twice
  return a.y() != b.y() ? (b.y() < a.y() ? 1 : -1) : sign_of(b.x() - a.x());
}

/// The sign of (a - p).((b - a) x (c - a)).
COLLIDE_HD_NOINLINE inline int sign_of_height_in_integers(triangle<double> const& t, vec3<double> const& p) {
  exact_slot::memory memory;
  exact_numbers const numbers = exact_numbers_of(memory.table(), t, {{p, 0}, {0, 0, 0}}, {0, 0});
  exact_products height;
  add_determinant(height, 1, exact_slot::corner, exact_slot::edge, exact_slot::edge + 3);
  return exact_sum::sign_of(numbers, height);
}

COLLIDE_HD_INLINE int sign_of_height(triangle<double> const& t, vec3<double> const& p) {
  vec3<double> const v = t.a - p, e = t.b - t.a, f = t.c - t.b;
  double height = 0, sum = 0;
  for (int i = 0; i < 3; ++i) {
    int const k = (i + 1) % 3, l = (i + 2) % 3;
    double const p1 = mul_rn(v[i], mul_rn(e[k], f[l])), p2 = mul_rn(v[i], mul_rn(e[l], f[k]));
    height += p1 - p2;
    sum += max(p1, -p1) + max(p2, -p2);
  }
  // guard: ray-height
  double const error = mul_rn(sum, 32 * ieee_traits<double>::unit_roundoff);
  if (sum > 0x1p-900 && sum < 0x1p1000 && (height > error || height < -error)) return sign_of(height);
  return sign_of_height_in_integers(t, p);
}

/// Decides where the ray from p, moved, along +z crosses a finite triangle. `on_line`: p itself lies on the line of an
/// edge, as seen from +z; else p is on the triangle only if the result is `at_point`.
COLLIDE_HD_NOINLINE inline ray_crossing cross_ray(triangle<double> const& t, vec3<double> const& p, bool& on_line) {
  int const ab = side_of_line(t.a, t.b, p), bc = side_of_line(t.b, t.c, p), ca = side_of_line(t.c, t.a, p);
  on_line = ab == 0 || bc == 0 || ca == 0;
  int const side = side_of_line_moved(ab, t.a, t.b);
  if (side == 0 || side_of_line_moved(bc, t.b, t.c) != side || side_of_line_moved(ca, t.c, t.a) != side)
    return ray_crossing::none;
  int const height = sign_of_height(t, p);
  if (height == 0) return ray_crossing::at_point;
  return height == side ? ray_crossing::above : ray_crossing::none;
}

}  // namespace collide::detail
