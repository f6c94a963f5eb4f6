#include "narrow_phase/near_contact.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "scenes.hpp"

namespace tests {
namespace {

using oracle::point;

point operator-(point const& p, point const& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
point operator*(double f, point const& p) { return {f * p.x, f * p.y, f * p.z}; }
double dot(point const& p, point const& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
point cross(point const& p, point const& q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
double length(point const& p) { return std::sqrt(dot(p, p)); }
point unit(point const& p) { return 1 / length(p) * p; }

template <class S>
point rounded(point const& p) {
  return {static_cast<S>(p.x), static_cast<S>(p.y), static_cast<S>(p.z)};
}

bool finite(point const& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }
bool finite(oracle::triangle const& t) { return finite(t.a) && finite(t.b) && finite(t.c); }

/// The number of `S` that is `steps` units in the last place above `x`.
template <class S>
double stepped(double x, int steps) {
  S const end = std::copysign(std::numeric_limits<S>::infinity(), static_cast<S>(steps));
  S at = static_cast<S>(x);
  for (; steps != 0; steps -= steps < 0 ? -1 : 1) at = std::nextafter(at, end);
  return at;
}

/// One of the 48 symmetries of the cube, and an order of the corners.
class symmetry {
 public:
  explicit symmetry(dice& roll) {
    for (int i = 2; i > 0; --i) {
      std::swap(axis_[i], axis_[roll.integer(0, i)]);
      std::swap(corner_[i], corner_[roll.integer(0, i)]);
    }
    for (double& s : sign_) s = roll.integer(0, 1) ? 1 : -1;
  }
  point operator()(point const& p) const {
    double const from[] = {p.x, p.y, p.z};
    return {sign_[0] * from[axis_[0]], sign_[1] * from[axis_[1]], sign_[2] * from[axis_[2]]};
  }
  oracle::triangle operator()(oracle::triangle const& t) const {
    point const from[] = {t.a, t.b, t.c};
    return {(*this)(from[corner_[0]]), (*this)(from[corner_[1]]), (*this)(from[corner_[2]])};
  }

 private:
  int axis_[3] = {0, 1, 2}, corner_[3] = {0, 1, 2};
  double sign_[3];
};

/// Appends the cases with radii of `least` to `most` units in the last place about the exact distance; false if that is
/// beyond the range of `S`. A ball that is a unit larger or smaller than the rounded distance leaves no doubt, so the
/// oracle is asked for the verdict of the middle, and for its neighbours' to be sure of the distance.
template <class S>
bool append(std::vector<near_case>& to, oracle::triangle const& t, point const& centre, int most, dice& roll) {
  double const distance = -oracle::depth(t, {centre, 0});
  if (!(distance < std::numeric_limits<S>::max())) return false;
  double const middle = stepped<S>(distance, 0);
  auto const hit = [&](int steps) { return oracle::hit(t, {centre, stepped<S>(middle, steps)}); };
  if (hit(-1) || !hit(1)) throw std::logic_error("oracle: the distance is not where the verdict changes");
  bool const touching = hit(0);
  for (int steps = -most; steps <= most; ++steps) {
    symmetry const turned(roll);
    bool const expected = steps > 0 || (steps == 0 && touching);
    to.push_back({turned(t), {turned(centre), stepped<S>(middle, steps)}, expected});
  }
  return true;
}

/// The same for a ball that moves.
template <class S>
bool append(std::vector<near_sweep>& to, oracle::triangle const& t, point const& centre, point const& move, int most,
            dice& roll) {
  double const distance = oracle::distance(t, centre, move);
  if (!(distance < std::numeric_limits<S>::max())) return false;
  double const middle = stepped<S>(distance, 0);
  auto const hit = [&](int steps) { return oracle::hit(t, {centre, stepped<S>(middle, steps)}, move); };
  if (hit(-1) || !hit(1)) throw std::logic_error("oracle: the distance is not where the verdict changes");
  bool const touching = hit(0);
  for (int steps = -most; steps <= most; ++steps) {
    symmetry const turned(roll);
    bool const expected = steps > 0 || (steps == 0 && touching);
    to.push_back({{turned(t), {turned(centre), stepped<S>(middle, steps)}, expected}, turned(move)});
  }
  return true;
}

double power_of_ten(dice& roll, double low, double high) { return std::pow(10, roll.uniform(low, high)); }

/// A triangle of about size 1, degenerate or a sliver now and then.
oracle::triangle any_triangle(dice& roll) {
  oracle::triangle t{roll.in_cube(1), roll.in_cube(1), roll.in_cube(1)};
  int const kind = roll.integer(0, 15);
  if (kind < 5) {  // a sliver: needle, cap or skinny
    double const along[] = {roll.uniform(0, 1), 0, 1, roll.uniform(-1, 2), 0.5};
    t.c = t.a + along[kind] * (t.b - t.a) + power_of_ten(roll, -7, -1) * roll.in_cube(1);
  }
  if (kind == 5 || kind == 6) t.c = t.b;
  if (kind == 6) t.b = t.a;
  if (kind == 7) t.c = t.a + static_cast<double>(roll.integer(-3, 3)) * (t.b - t.a);
  return t;
}

/// A unit vector from the point `at` of a feature into the part of space to which that feature is the closest.
point outward(oracle::triangle const& t, int feature, dice& roll) {
  point const normal = cross(t.b - t.a, t.c - t.a);
  if (feature == 0 && dot(normal, normal) > 0) return (roll.integer(0, 1) ? 1 : -1) * unit(normal);
  for (int attempt = 0; attempt < 30; ++attempt) {
    point d = roll.in_cube(1);
    if (feature == 1) {  // perpendicular to ab
      point const ab = t.b - t.a;
      if (dot(ab, ab) > 0) d = d - dot(d, ab) / dot(ab, ab) * ab;
    }
    if (dot(d, d) > 0 && dot(d, t.b - t.a) <= 1e-12 && dot(d, t.c - t.a) <= 0) return unit(d);
  }
  return unit(t.a - 0.5 * (t.b + t.c) + 0x1p-30 * roll.in_cube(1));
}

int scale_exponent(dice& roll, bool wide) {
  if (roll.integer(0, 1)) return 0;
  return wide && roll.integer(0, 1) ? roll.integer(-1060, 1000) : roll.integer(-140, 120);
}

struct lattice_point {
  std::int64_t x, y, z;

  friend lattice_point operator+(lattice_point p, lattice_point q) { return {p.x + q.x, p.y + q.y, p.z + q.z}; }
  friend lattice_point operator*(std::int64_t f, lattice_point p) { return {f * p.x, f * p.y, f * p.z}; }
};

std::int64_t dot(lattice_point p, lattice_point q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
lattice_point cross(lattice_point p, lattice_point q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

lattice_point in_lattice(dice& roll, int half) {
  int const x = roll.integer(-half, half), y = roll.integer(-half, half), z = roll.integer(-half, half);
  return {x, y, z};
}

/// Three points around or beside the origin, none of them on the positive side of the plane through it with this
/// normal: the origin lies on the face (feature 0), the edge ab (1) or is the vertex a (2), and is the point of the
/// triangle that is closest to all points of the normal.
void around_origin(lattice_point (&corners)[3], lattice_point normal, int feature, dice& roll) {
  if (feature == 0) {
    lattice_point const u = cross(normal, std::abs(normal.x) < std::abs(normal.y) ? lattice_point{1, 0, 0}
                                                                                  : lattice_point{0, 1, 0}),
                        v = cross(normal, u);
    lattice_point on_plane[3];
    do {
      for (auto& p : on_plane) p = {roll.integer(-3, 3), roll.integer(-3, 3), 0};
    } while (cross(on_plane[0], on_plane[1]).z <= 0 || cross(on_plane[1], on_plane[2]).z <= 0 ||
             cross(on_plane[2], on_plane[0]).z <= 0);
    for (int i = 0; i < 3; ++i) corners[i] = on_plane[i].x * u + on_plane[i].y * v;
    return;
  }
  for (auto& p : corners) {
    p = roll.integer(1, 5) * in_lattice(roll, 3);
    if (dot(p, normal) > 0) p = -1 * p;
  }
  corners[0] = {0, 0, 0};
  if (feature == 1) {
    lattice_point const along = cross(normal, in_lattice(roll, 3));
    corners[0] = -roll.integer(1, 3) * along;
    corners[1] = roll.integer(1, 3) * along;
  }
}

}  // namespace

std::string describe(near_case const& c) {
  auto const& [a, b, d] = c.shape;
  auto const& [p, r] = c.ball;
  char text[512];
  std::snprintf(text, sizeof text, "%d,%a,%a,%a,%a,%a,%a,%a,%a,%a,%a,%a,%a,%a", c.hit, a.x, a.y, a.z, b.x, b.y, b.z,
                d.x, d.y, d.z, p.x, p.y, p.z, r);
  return text;
}

std::string describe(near_sweep const& c) {
  char text[128];
  std::snprintf(text, sizeof text, ", moving %a,%a,%a", c.move.x, c.move.y, c.move.z);
  return describe(static_cast<near_case const&>(c)) + text;
}

template <class S>
std::vector<near_case> near_contact(unsigned seed, std::size_t n) {
  dice roll(seed);
  std::vector<near_case> made;
  while (made.size() < 9 * n) {
    oracle::triangle const t = any_triangle(roll);
    int const feature = roll.integer(0, 2);  // face, edge, vertex
    double const to_b = feature == 2 ? 0 : roll.uniform(0, 1),
                 to_c = feature == 0 ? roll.uniform(0, 1) * (1 - to_b) : 0;
    point const at = t.a + to_b * (t.b - t.a) + to_c * (t.c - t.a);
    point const centre = at + power_of_ten(roll, -6, 6) * outward(t, feature, roll);
    point const offset = roll.integer(0, 1) ? point{0, 0, 0} : roll.in_cube(power_of_ten(roll, 0, 6));
    double const scale = std::ldexp(1, scale_exponent(roll, sizeof(S) == 8));
    auto const placed = [&](point const& p) { return rounded<S>(scale * (p + offset)); };
    oracle::triangle const shape{placed(t.a), placed(t.b), placed(t.c)};
    point const p = placed(centre);
    if (finite(shape) && finite(p)) append<S>(made, shape, p, 4, roll);
  }
  return made;
}

template <class S>
std::vector<near_sweep> near_sweeps(unsigned seed, std::size_t n) {
  dice roll(seed);
  std::vector<near_sweep> made;
  while (made.size() < 9 * n) {
    oracle::triangle const t = any_triangle(roll);
    int const feature = roll.integer(0, 2);  // face, edge, vertex
    double const to_b = feature == 2 ? 0 : roll.uniform(0, 1),
                 to_c = feature == 0 ? roll.uniform(0, 1) * (1 - to_b) : 0;
    point const at = t.a + to_b * (t.b - t.a) + to_c * (t.c - t.a), away = outward(t, feature, roll);
    point const closest = at + power_of_ten(roll, -6, 3) * away;
    double const times[] = {0, 1, roll.uniform(0, 1), roll.uniform(0, 1)}, time = times[roll.integer(0, 3)];
    point move = power_of_ten(roll, -3, 3) * roll.in_cube(1);
    double const leaving = dot(move, away);
    if (time != 0 && time != 1) move = move - leaving * away;
    if ((time == 0 && leaving < 0) || (time == 1 && leaving > 0)) move = -1 * move;
    point const offset = roll.integer(0, 1) ? point{0, 0, 0} : roll.in_cube(power_of_ten(roll, 0, 6));
    double const scale = std::ldexp(1, scale_exponent(roll, sizeof(S) == 8));
    auto const placed = [&](point const& p) { return rounded<S>(scale * (p + offset)); };
    oracle::triangle const shape{placed(t.a), placed(t.b), placed(t.c)};
    point const p = placed(closest - time * move), d = rounded<S>(scale * move);
    if (finite(shape) && finite(p) && finite(d) && oracle::distance(shape, p, d) > 0) {
      append<S>(made, shape, p, d, 4, roll);
    }
  }
  return made;
}

template <class S>
std::vector<near_sweep> lattice_sweeps(unsigned seed, std::size_t n) {
  dice roll(seed);
  std::vector<near_sweep> made;
  for (std::size_t i = 0; i < n; ++i) {
    int const half = 1 + static_cast<int>(i % 4);
    auto const any = [&] {
      lattice_point const p = in_lattice(roll, half);
      return point{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
    };
    oracle::triangle const t{any(), any(), any()};
    oracle::sphere const s{any(), 0.5 * roll.integer(0, 3)};
    point const move = any();
    made.push_back({{t, s, oracle::hit(t, s, move)}, move});
  }
  return made;
}

template <class S>
std::vector<near_case> ties(unsigned seed, std::size_t n) {
  constexpr int digits = std::numeric_limits<S>::digits, most = sizeof(S) == 4 ? 4 : 40;
  constexpr int least_exponent = std::numeric_limits<S>::min_exponent - digits;
  dice roll(seed);
  std::vector<near_case> made;
  while (made.size() < 3 * n) {
    std::int64_t const k = roll.integer(0, most), l = roll.integer(0, most), m = roll.integer(0, most),
                       o = roll.integer(0, most);
    lattice_point const normal{k * k + l * l - m * m - o * o, 2 * (k * o + l * m), 2 * (l * o - k * m)};
    std::int64_t const norm = k * k + l * l + m * m + o * o;
    if (norm == 0) continue;
    lattice_point corners[3];
    around_origin(corners, normal, roll.integer(0, 2), roll);
    std::int64_t const away = roll.integer(1, 16);
    double const limit = std::ldexp(1, digits - roll.integer(1, digits - 1));
    auto const anywhere = [&] { return static_cast<std::int64_t>(roll.uniform(-limit, limit)); };
    lattice_point const offset{anywhere(), anywhere(), anywhere()};
    bool fits = true;
    double const scale = std::ldexp(
        1, roll.integer(0, 1) ? 0 : roll.integer(least_exponent, std::numeric_limits<S>::max_exponent - digits));
    auto const placed = [&](lattice_point p) {
      p = p + offset;
      for (auto x : {p.x, p.y, p.z}) fits = fits && std::abs(static_cast<double>(x)) <= std::ldexp(1, digits);
      return scale * point{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
    };
    oracle::triangle const t{placed(corners[0]), placed(corners[1]), placed(corners[2])};
    point const centre = placed(away * normal);
    if (!fits || !append<S>(made, t, centre, 1, roll)) continue;
    if (made.back().ball.radius != stepped<S>(scale * static_cast<double>(away * norm), 1) || !made.end()[-2].hit)
      throw std::logic_error("not a tie");
  }
  return made;
}

namespace {

/// Coordinates of a few exponents out of all that `S` has.
template <class S>
class mixed_coordinates {
 public:
  explicit mixed_coordinates(dice& roll) : roll_(roll) {
    constexpr int least = std::numeric_limits<S>::min_exponent - std::numeric_limits<S>::digits,
                  greatest = std::numeric_limits<S>::max_exponent - 1;
    for (int& e : exponents_)
      e = roll.integer(0, 3) == 0 ? greatest - roll.integer(0, 2) : roll.integer(least, greatest);
    centre_ = anywhere();
  }

  point centre() const { return centre_; }

  point anywhere() {
    double const x = any(), y = any(), z = any();
    return {x, y, z};
  }

  /// Some of the coordinates are equal, or next to equal, to those of the centre.
  point corner() {
    double const x = near(centre_.x), y = near(centre_.y), z = near(centre_.z);
    return {x, y, z};
  }

 private:
  double any() {
    if (roll_.integer(0, 7) == 0) return 0;
    double const mantissa = roll_.integer(0, 1) ? 1 : roll_.uniform(1, 2);
    return static_cast<S>(std::ldexp(roll_.integer(0, 1) ? mantissa : -mantissa, exponents_[roll_.integer(0, 2)]));
  }
  double near(double x) {
    int const kind = roll_.integer(0, 4);
    return kind < 2 ? x : kind == 2 ? stepped<S>(x, roll_.integer(-3, 3)) : any();
  }

  dice& roll_;
  int exponents_[3];
  point centre_;
};

}  // namespace

template <class S>
std::vector<near_case> mixed_exponents(unsigned seed, std::size_t n) {
  dice roll(seed);
  std::vector<near_case> made;
  while (made.size() < 3 * n) {
    mixed_coordinates<S> some(roll);
    point const a = some.corner(), b = some.corner(), c = some.corner();
    if (finite(oracle::triangle{a, b, c})) append<S>(made, {a, b, c}, some.centre(), 1, roll);
  }
  return made;
}

template <class S>
std::vector<near_sweep> mixed_sweeps(unsigned seed, std::size_t n) {
  dice roll(seed);
  std::vector<near_sweep> made;
  while (made.size() < 3 * n) {
    mixed_coordinates<S> some(roll);
    point const a = some.corner(), b = some.corner(), c = some.corner(), move = some.anywhere();
    if (finite(oracle::triangle{a, b, c})) append<S>(made, {a, b, c}, some.centre(), move, 1, roll);
  }
  return made;
}

template std::vector<near_case> near_contact<float>(unsigned, std::size_t);
template std::vector<near_case> near_contact<double>(unsigned, std::size_t);
template std::vector<near_case> ties<float>(unsigned, std::size_t);
template std::vector<near_case> ties<double>(unsigned, std::size_t);
template std::vector<near_case> mixed_exponents<float>(unsigned, std::size_t);
template std::vector<near_case> mixed_exponents<double>(unsigned, std::size_t);
template std::vector<near_sweep> near_sweeps<float>(unsigned, std::size_t);
template std::vector<near_sweep> near_sweeps<double>(unsigned, std::size_t);
template std::vector<near_sweep> lattice_sweeps<float>(unsigned, std::size_t);
template std::vector<near_sweep> lattice_sweeps<double>(unsigned, std::size_t);
template std::vector<near_sweep> mixed_sweeps<float>(unsigned, std::size_t);
template std::vector<near_sweep> mixed_sweeps<double>(unsigned, std::size_t);

}  // namespace tests
