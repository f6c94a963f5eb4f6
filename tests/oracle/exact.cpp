#include "exact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>

namespace oracle {
namespace {

namespace mp = boost::multiprecision;
using real = mp::cpp_bin_float_100;

/// A finite double as mantissa * 2^exponent, taken from its bits: no flag of the compiler or mode of the processor
/// interferes.
struct decoded {
  std::int64_t mantissa;
  int exponent;

  explicit decoded(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    auto const biased = static_cast<int>(bits >> 52 & 0x7ff);
    auto const fraction = static_cast<std::int64_t>(bits & 0xfffffffffffff);
    mantissa = biased == 0 ? fraction : fraction | std::int64_t{1} << 52;
    exponent = std::max(biased, 1) - 1075;
    for (; mantissa != 0 && mantissa % 2 == 0; mantissa /= 2) ++exponent;
    if (bits >> 63) mantissa = -mantissa;
  }

  int bits() const {
    int count = 0;
    for (auto rest = mantissa; rest != 0; rest /= 2) ++count;
    return count;
  }
};

template <class Int>
struct vec {
  Int x, y, z;
};

template <class Int>
vec<Int> operator-(vec<Int> const& u, vec<Int> const& v) {
  return {u.x - v.x, u.y - v.y, u.z - v.z};
}

template <class Int>
Int dot(vec<Int> const& u, vec<Int> const& v) {
  return u.x * v.x + u.y * v.y + u.z * v.z;
}

template <class Int>
vec<Int> cross(vec<Int> const& u, vec<Int> const& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// A point of the triangle that may be the closest to the origin: its squared distance as num / den, den > 0, the point
/// as at / den.
template <class Int>
struct candidate {
  unsigned feature;
  Int num, den;
  vec<Int> at;
};

/// Calls f with every candidate: the three vertices, the foot of the perpendicular to every edge and to the face where
/// it lies in the interior. The closest point to the origin is one of them, and all of them are points of the triangle.
template <class Int, class F>
void for_each_candidate(std::array<vec<Int>, 3> const& v, F f) {
  vec<Int> edge[3];
  for (unsigned i = 0; i < 3; ++i) {
    auto const& a = v[i];
    edge[i] = v[(i + 1) % 3] - a;
    f(candidate<Int>{vertex_a << i, dot(a, a), 1, a});
    Int const length2 = dot(edge[i], edge[i]), t = -dot(a, edge[i]);
    if (t > 0 && t < length2) {
      vec<Int> const at{a.x * length2 + edge[i].x * t, a.y * length2 + edge[i].y * t, a.z * length2 + edge[i].z * t};
      f(candidate<Int>{edge_ab << i, dot(a, a) * length2 - t * t, length2, at});
    }
  }
  vec<Int> const normal = cross(edge[0], edge[1]);
  Int const area2 = dot(normal, normal);
  if (area2 == 0) return;
  for (unsigned i = 0; i < 3; ++i)
    if (dot(normal, cross(v[i], edge[i])) <= 0)
      return;  // cross(edge, 0 - v): the origin's side of the edge, seen along the normal
  Int const height = dot(normal, v[0]);
  f(candidate<Int>{face, height * height, area2, {normal.x * height, normal.y * height, normal.z * height}});
}

/// The inputs as integers: value = integer * 2^exponent, the same exponent for all of them.
struct scaled {
  std::array<decoded, 16> values;
  int exponent, bits;

  explicit scaled(triangle const& t, point const& p, double radius, point const& move = {0, 0, 0})
      : values{{decoded(t.a.x), decoded(t.a.y), decoded(t.a.z), decoded(t.b.x), decoded(t.b.y), decoded(t.b.z),
                decoded(t.c.x), decoded(t.c.y), decoded(t.c.z), decoded(p.x), decoded(p.y), decoded(p.z),
                decoded(move.x), decoded(move.y), decoded(move.z), decoded(radius)}} {
    int top = -5000;
    exponent = 5000;
    for (auto const& value : values)
      if (value.mantissa != 0) {
        exponent = std::min(exponent, value.exponent);
        top = std::max(top, value.exponent + value.bits());
      }
    bits = std::max(top - exponent, 0);
  }

  template <class Int>
  Int integer(std::size_t i) const {
    auto const [mantissa, power] = values[i];
    if (mantissa == 0) return 0;
    Int const magnitude = Int(std::abs(mantissa)) << (power - exponent);  // checked integers shift no negative numbers
    return mantissa < 0 ? Int(-magnitude) : magnitude;
  }

  template <class Int>
  vec<Int> vector(std::size_t i) const {
    return {integer<Int>(3 * i), integer<Int>(3 * i + 1), integer<Int>(3 * i + 2)};
  }

  /// The triangle as seen from the point.
  template <class Int>
  std::array<vec<Int>, 3> local() const {
    auto const p = vector<Int>(3);
    return {vector<Int>(0) - p, vector<Int>(1) - p, vector<Int>(2) - p};
  }

  template <class Int>
  bool hit() const {
    Int const radius = integer<Int>(15), radius2 = radius * radius;
    bool found = false;
    for_each_candidate<Int>(local<Int>(), [&](auto const& c) { found = found || c.num <= radius2 * c.den; });
    return found;
  }
};

/// As seen from a ball that moves, the triangle moves the other way and sweeps out a prism: from `v` along -`move`.
/// Calls f with three corners for each of the eight triangles that the prism's surface is made of, all of it if it is
/// flat.
template <class Int, class F>
void for_each_side(std::array<vec<Int>, 3> const& v, vec<Int> const& move, F f) {
  using corners = std::array<vec<Int>, 3>;
  corners const moved{v[0] - move, v[1] - move, v[2] - move};
  f(v);
  f(moved);
  for (unsigned i = 0; i < 3; ++i) {
    unsigned const j = (i + 1) % 3;
    f(corners{v[i], v[j], moved[i]});
    f(corners{moved[i], moved[j], v[j]});
  }
}

/// Is the origin in the prism, and that not flat? Then the ball's centre goes through the triangle.
template <class Int>
bool through(std::array<vec<Int>, 3> const& v, vec<Int> const& move) {
  // move * t = v0 + (v1 - v0) * f + (v2 - v0) * g, by Cramer's rule
  vec<Int> const p = v[1] - v[0], q = v[2] - v[0];
  Int whole = dot(move, cross(p, q));
  if (whole == 0) return false;
  Int t = dot(v[0], cross(p, q)), f = dot(move, cross(q, v[0])), g = dot(move, cross(v[0], p));
  if (whole < 0) {
    whole = -whole;
    t = -t;
    f = -f;
    g = -g;
  }
  return t >= 0 && t <= whole && f >= 0 && g >= 0 && f + g <= whole;
}

/// Does a ball around the origin touch the triangle, anywhere on its way along `move`?
template <class Int>
bool swept_hit(std::array<vec<Int>, 3> const& v, vec<Int> const& move, Int const& radius) {
  Int const radius2 = radius * radius;
  bool found = false;
  for_each_side<Int>(v, move, [&](std::array<vec<Int>, 3> const& side) {
    if (!found) for_each_candidate<Int>(side, [&](auto const& c) { found = found || c.num <= radius2 * c.den; });
  });
  return found || through<Int>(v, move);
}

bool finite(point const& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// The closest of all candidates; its `feature` collects the bits of all that are as close.
candidate<mp::cpp_int> nearest(scaled const& s) {
  candidate<mp::cpp_int> best{0, 0, 0, {}};
  for_each_candidate<mp::cpp_int>(s.local<mp::cpp_int>(), [&](auto const& c) {
    if (best.feature == 0 || c.num * best.den < best.num * c.den)
      best = c;
    else if (c.num * best.den == best.num * c.den)
      best.feature |= c.feature;
  });
  return best;
}

real distance(candidate<mp::cpp_int> const& c, int exponent) {
  return ldexp(sqrt(real(c.num) / real(c.den)), exponent);
}

}  // namespace

bool hit(triangle const& t, sphere const& s) {
  if (!finite(t.a) || !finite(t.b) || !finite(t.c) || !finite(s.centre) || !(s.radius >= 0)) return false;
  if (std::isinf(s.radius)) return true;
  scaled const inputs(t, s.centre, s.radius);
  // No intermediate is longer than 6 * bits + 12: the face's height^2, of degree 6 in coordinate differences.
  // Were that wrong, the checked integers would throw.
  if (inputs.bits <= 40) return inputs.hit<mp::checked_int256_t>();
  if (inputs.bits <= 82) return inputs.hit<mp::checked_int512_t>();
  return inputs.hit<mp::cpp_int>();
}

namespace {

/// Is the triangle touched at some time from 0 to numerator / 2^shift?
bool touched_until(triangle const& t, sphere const& s, point const& move, mp::cpp_int const& numerator,
                   unsigned shift) {
  if (!finite(t.a) || !finite(t.b) || !finite(t.c) || !finite(s.centre) || !finite(move)) return false;
  if (!(s.radius >= 0)) return false;
  if (std::isinf(s.radius)) return true;
  scaled const inputs(t, s.centre, s.radius, move);
  auto const check = [&](auto zero) {
    using Int = decltype(zero);
    auto const longer = [&](Int const& x) -> Int { return x * (Int(1) << shift); };
    auto const longer_vector = [&](vec<Int> const& u) { return vec<Int>{longer(u.x), longer(u.y), longer(u.z)}; };
    auto const v = inputs.local<Int>();
    auto const d = inputs.vector<Int>(4);
    Int const m(numerator);
    return swept_hit<Int>({longer_vector(v[0]), longer_vector(v[1]), longer_vector(v[2])}, {d.x * m, d.y * m, d.z * m},
                          longer(inputs.integer<Int>(15)));
  };
  // as below, with differences one bit longer
  int const bits = inputs.bits + static_cast<int>(shift);
  if (bits <= 38) return check(mp::checked_int256_t(0));
  if (bits <= 80) return check(mp::checked_int512_t(0));
  return check(mp::cpp_int(0));
}

bool touched_until(triangle const& t, sphere const& s, point const& move, double time, bool strictly) {
  decoded const at(time);
  auto shift = static_cast<unsigned>(std::max(-at.exponent, 0));
  mp::cpp_int numerator = mp::cpp_int(at.mantissa) << std::max(at.exponent, 0);
  if (strictly) {
    if (time <= 0) return false;
    numerator = (numerator << 300) - 1;
    shift += 300;
  }
  return touched_until(t, s, move, numerator, shift);
}

}  // namespace

bool hit(triangle const& t, sphere const& s, point const& move) { return touched_until(t, s, move, 1, 0); }

bool hit_by(triangle const& t, sphere const& s, point const& move, double time) {
  return touched_until(t, s, move, time, false);
}

bool hit_before(triangle const& t, sphere const& s, point const& move, double time) {
  return touched_until(t, s, move, time, true);
}

double impact_time(triangle const& t, sphere const& s, point const& move) {
  if (hit_by(t, s, move, 0)) return 0;
  std::uint64_t low = 0, high;  // the bits of positive doubles sort as the doubles do
  double const one = 1;
  std::memcpy(&high, &one, sizeof high);
  while (high - low > 1) {
    std::uint64_t const middle = low + (high - low) / 2;
    double time;
    std::memcpy(&time, &middle, sizeof time);
    (hit_by(t, s, move, time) ? high : low) = middle;
  }
  double first;
  std::memcpy(&first, &high, sizeof first);
  return first;
}

closest_point closest(triangle const& t, point const& p) {
  scaled const inputs(t, p, 0);
  auto const best = nearest(inputs);
  auto const on_axis = [&](mp::cpp_int const& at, double origin) {
    return static_cast<double>(ldexp(real(at) / real(best.den), inputs.exponent) + real(origin));
  };
  auto const seen_from = [&](point const& origin) {
    return point{on_axis(best.at.x, origin.x), on_axis(best.at.y, origin.y), on_axis(best.at.z, origin.z)};
  };
  return {static_cast<double>(distance(best, inputs.exponent)), seen_from(p), seen_from({0, 0, 0}), best.feature};
}

double depth(triangle const& t, sphere const& s) {
  scaled const inputs(t, s.centre, s.radius);
  auto const best = nearest(inputs);
  // R - d = (R^2 - d^2) / (R + d), and the difference of the squares is exact
  mp::cpp_int const radius = inputs.integer<mp::cpp_int>(15), above = radius * radius * best.den - best.num;
  if (above == 0) return 0;
  real const sum = real(radius) + sqrt(real(best.num) / real(best.den));
  return static_cast<double>(ldexp(real(above) / (real(best.den) * sum), inputs.exponent));
}

double distance(triangle const& t, point const& p, point const& move) {
  scaled const inputs(t, p, 0, move);
  auto const v = inputs.local<mp::cpp_int>();
  auto const d = inputs.vector<mp::cpp_int>(4);
  if (through<mp::cpp_int>(v, d)) return 0;
  candidate<mp::cpp_int> best{0, 0, 0, {}};
  for_each_side<mp::cpp_int>(v, d, [&](auto const& side) {
    for_each_candidate<mp::cpp_int>(side, [&](auto const& c) {
      if (best.feature == 0 || c.num * best.den < best.num * c.den) best = c;
    });
  });
  return static_cast<double>(distance(best, inputs.exponent));
}

int compare_distances(triangle const& s, triangle const& t, point const& p) {
  scaled const from_s(s, p, 0), from_t(t, p, 0);
  auto const best_s = nearest(from_s), best_t = nearest(from_t);
  // squared distance = num / den * 4^exponent
  int const shift = 2 * (from_s.exponent - from_t.exponent);
  mp::cpp_int const left = best_s.num * best_t.den << std::max(shift, 0),
                    right = best_t.num * best_s.den << std::max(-shift, 0);
  return left.compare(right) < 0 ? -1 : left.compare(right) > 0;
}

bool inside(std::vector<triangle> const& mesh, point const& p) {
  if (!finite(p)) return false;
  for (auto const& t : mesh)
    if (hit(t, {p, 0})) return true;
  for (int attempt = 0;; ++attempt) {
    vec<mp::cpp_int> const ray{104729 + 1299709 * attempt, 7919 - 15485863 * attempt, 86028121 + attempt};
    bool odd = false, generic = true;
    for (auto const& t : mesh) {
      if (!finite(t.a) || !finite(t.b) || !finite(t.c)) continue;
      auto const v = scaled(t, p, 0).local<mp::cpp_int>();
      int sides[3];
      for (unsigned i = 0; i < 3; ++i) sides[i] = dot(ray, cross(v[i], v[(i + 1) % 3])).sign();
      auto const normal = cross(vec<mp::cpp_int>(v[1] - v[0]), vec<mp::cpp_int>(v[2] - v[0]));
      if (dot(normal, normal) == 0) continue;  // no ray that meets no edge crosses it
      int const facing = dot(ray, normal).sign(), ahead = dot(v[0], normal).sign() * facing;
      bool const crosses = sides[0] == sides[1] && sides[1] == sides[2] && sides[0] != 0;
      bool const beside =
          (sides[0] > 0 || sides[1] > 0 || sides[2] > 0) && (sides[0] < 0 || sides[1] < 0 || sides[2] < 0);
      generic = generic && (crosses || beside);
      odd = odd != (crosses && ahead > 0);
    }
    if (generic) return odd;
  }
}

bool touch(sphere const& a, sphere const& b) {
  for (double const x : {a.centre.x, a.centre.y, a.centre.z, b.centre.x, b.centre.y, b.centre.z})
    if (!std::isfinite(x)) return false;
  if (!(a.radius >= 0) || !(b.radius >= 0)) return false;
  if (std::isinf(a.radius) || std::isinf(b.radius)) return true;
  double const numbers[] = {a.centre.x, a.centre.y, a.centre.z, a.radius, b.centre.x, b.centre.y, b.centre.z, b.radius};
  int lowest = 10000;
  for (double const x : numbers) lowest = std::min(lowest, decoded(x).exponent);
  auto const integer = [&](int i) -> mp::cpp_int {
    decoded const d(numbers[i]);
    return mp::cpp_int(d.mantissa) << (d.mantissa == 0 ? 0 : d.exponent - lowest);
  };
  mp::cpp_int squared = 0;
  for (int k = 0; k < 3; ++k) {
    mp::cpp_int const between = integer(k) - integer(k + 4);
    squared += between * between;
  }
  mp::cpp_int const reach = integer(3) + integer(7);
  return squared <= reach * reach;
}

namespace {

using place = vec<mp::cpp_rational>;

place place_of(point const& p) { return {mp::cpp_rational(p.x), mp::cpp_rational(p.y), mp::cpp_rational(p.z)}; }

bool equal(place const& p, place const& q) { return p.x == q.x && p.y == q.y && p.z == q.z; }

/// The part of a convex polygon where (x - at).inward >= 0.
std::vector<place> clipped(std::vector<place> const& polygon, place const& at, place const& inward) {
  std::vector<place> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    place const &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    mp::cpp_rational const h = dot<mp::cpp_rational>(p - at, inward), k = dot<mp::cpp_rational>(q - at, inward);
    if (h >= 0) kept.push_back(p);
    if ((h > 0 && k < 0) || (h < 0 && k > 0)) {
      mp::cpp_rational const f = h / (h - k);
      kept.push_back({p.x + f * (q.x - p.x), p.y + f * (q.y - p.y), p.z + f * (q.z - p.z)});
    }
  }
  return kept;
}

}  // namespace

bool meet(triangle const& s, triangle const& t) {
  for (auto const* const p : {&s.a, &s.b, &s.c, &t.a, &t.b, &t.c})
    if (!finite(*p)) return false;
  place const u[3] = {place_of(s.a), place_of(s.b), place_of(s.c)},
              v[3] = {place_of(t.a), place_of(t.b), place_of(t.c)};
  place const of_s = cross<mp::cpp_rational>(u[1] - u[0], u[2] - u[0]),
              of_t = cross<mp::cpp_rational>(v[1] - v[0], v[2] - v[0]);
  if (dot(of_s, of_s) == 0 || dot(of_t, of_t) == 0) return false;
  std::vector<place> common{u[0], u[1], u[2]}, shared;
  common = clipped(clipped(common, v[0], of_t), v[0], {-of_t.x, -of_t.y, -of_t.z});
  for (unsigned i = 0; i < 3; ++i) common = clipped(common, v[i], cross<mp::cpp_rational>(of_t, v[(i + 1) % 3] - v[i]));
  for (auto const& p : u)
    for (auto const& q : v)
      if (equal(p, q)) shared.push_back(p);
  if (shared.size() == 3) return true;
  for (auto const& p : common) {
    if (shared.empty()) return true;
    place const along = shared.back() - shared.front(), to = p - shared.front(), aside = cross(along, to);
    bool const beside = dot(aside, aside) != 0 || dot(to, along) < 0 || dot(to, along) > dot(along, along);
    if (shared.size() == 1 ? !equal(p, shared[0]) : beside) return true;
  }
  return false;
}

}  // namespace oracle
