/// Who watches the oracle: every row of the hard cases, and a second exact formulation with other arithmetic (rationals
/// straight from the doubles) and another idea (Voronoi regions instead of the minimum over all features).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

#include <boost/multiprecision/cpp_int.hpp>
#include <doctest/doctest.h>

#include "scene.hpp"

namespace {

using oracle::point;
using oracle::sphere;
using oracle::triangle;
using rational = boost::multiprecision::cpp_rational;

struct vec {
  rational x, y, z;

  explicit vec(point const& p) : x(p.x), y(p.y), z(p.z) {}
  vec(rational a, rational b, rational c) : x(std::move(a)), y(std::move(b)), z(std::move(c)) {}
  friend vec operator-(vec const& u, vec const& v) { return {u.x - v.x, u.y - v.y, u.z - v.z}; }
  friend vec operator+(vec const& u, vec const& v) { return {u.x + v.x, u.y + v.y, u.z + v.z}; }
  friend vec operator*(rational const& f, vec const& v) { return {f * v.x, f * v.y, f * v.z}; }
  friend rational operator*(vec const& u, vec const& v) { return u.x * v.x + u.y * v.y + u.z * v.z; }
};

vec closest_on_segment(vec const& a, vec const& b, vec const& p) {
  rational const length2 = (b - a) * (b - a);
  if (length2 == 0) return a;
  rational const t = (p - a) * (b - a) / length2;
  return t <= 0 ? a : t >= 1 ? b : a + t * (b - a);
}

/// Which of the seven Voronoi regions is p in? After C. Ericson, Real-Time Collision Detection, 5.1.5.
rational squared_distance_by_regions(triangle const& t, point const& at) {
  vec const a(t.a), b(t.b), c(t.c), p(at), ab = b - a, ac = c - a;
  auto const to = [&](vec const& q) -> rational { return (p - q) * (p - q); };
  if ((ab * ab) * (ac * ac) == (ab * ac) * (ab * ac))  // collinear
    return std::min(
        {to(closest_on_segment(a, b, p)), to(closest_on_segment(b, c, p)), to(closest_on_segment(c, a, p))});
  rational const d1 = ab * (p - a), d2 = ac * (p - a), d3 = ab * (p - b), d4 = ac * (p - b), d5 = ab * (p - c),
                 d6 = ac * (p - c);
  if (d1 <= 0 && d2 <= 0) return to(a);
  if (d3 >= 0 && d4 <= d3) return to(b);
  if (d6 >= 0 && d5 <= d6) return to(c);
  rational const va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return to(a + d1 / (d1 - d3) * ab);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return to(a + d2 / (d2 - d6) * ac);
  if (va <= 0 && d4 >= d3 && d5 >= d6) return to(b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b));
  rational const sum = va + vb + vc;
  return to(a + vb / sum * ab + vc / sum * ac);
}

bool hit_by_regions(triangle const& t, sphere const& s) {
  for (double x : {t.a.x, t.a.y, t.a.z, t.b.x, t.b.y, t.b.z, t.c.x, t.c.y, t.c.z, s.centre.x, s.centre.y, s.centre.z})
    if (!std::isfinite(x)) return false;
  if (!(s.radius >= 0)) return false;
  return std::isinf(s.radius) || squared_distance_by_regions(t, s.centre) <= rational(s.radius) * rational(s.radius);
}

std::string const data = TEST_DATA_DIR;

}  // namespace

TEST_CASE("oracle: both formulations give the verdict of every hard case") {
  for (bool const single : {true, false}) {
    std::string const file = single ? "static_f32.csv" : "static_f64.csv";
    auto const cases = oracle::read_hard_cases(data + "/" + file, single);
    CHECK(cases.size() == (single ? 4785 : 486));
    for (auto const& row : cases) {
      CAPTURE(file);
      CAPTURE(row.id);
      CAPTURE(row.sub);
      CHECK(oracle::hit(row.shape, row.ball) == row.hit);
      CHECK(hit_by_regions(row.shape, row.ball) == row.hit);
    }
  }
}

TEST_CASE("oracle: every swept case") {
  int still = 0;
  auto const cases = oracle::read_hard_cases(data + "/swept_f32.csv", true);
  CHECK(cases.size() == 645);
  for (auto const& row : cases) {
    CAPTURE(row.id);
    CAPTURE(row.sub);
    CHECK(oracle::hit(row.shape, row.ball, row.move) == row.hit);
    if (row.move.x != 0 || row.move.y != 0 || row.move.z != 0) continue;
    ++still;
    CHECK(oracle::hit(row.shape, row.ball) == row.hit);
  }
  CHECK(still > 0);
}

TEST_CASE("oracle: a sweep touches if and only if some place on the way does") {
  // Sampled: never a hit where the sweep has none; and the first contact is one, with none before.
  std::mt19937 random(5);
  auto const coordinate = [&](int range) {
    return static_cast<double>(random() % (2u * static_cast<unsigned>(range) + 1)) - range;
  };
  int hits = 0, later = 0;
  for (int i = 0; i < 5000; ++i) {
    int const range = 1 + i % 4;
    auto const any = [&] { return point{coordinate(range), coordinate(range), coordinate(range)}; };
    triangle const t{any(), any(), any()};
    sphere const s{any(), static_cast<double>(random() % 4) / 2};
    point const move = any();
    bool const touched = oracle::hit(t, s, move);
    double const distance = oracle::distance(t, s.centre, move);
    CAPTURE(i);
    REQUIRE(oracle::hit(t, {s.centre, distance + 1e-14}, move));
    REQUIRE_FALSE(oracle::hit(t, {s.centre, distance - 1e-14}, move));
    auto const at = [&](double time) {
      return sphere{{s.centre.x + time * move.x, s.centre.y + time * move.y, s.centre.z + time * move.z}, s.radius};
    };
    bool sampled = false;
    for (int k = 0; k <= 32; ++k) {
      bool const here = oracle::hit(t, at(k / 32.0));
      sampled = sampled || here;
      REQUIRE(oracle::hit_by(t, s, move, k / 32.0) >= sampled);
    }
    REQUIRE(touched >= sampled);
    hits += touched;
    if (!touched) continue;
    double const first = oracle::impact_time(t, s, move);
    REQUIRE(oracle::hit_by(t, s, move, first));
    REQUIRE_FALSE(oracle::hit_before(t, s, move, std::nextafter(first, 0)));
    REQUIRE((first == 0) == hit_by_regions(t, s));
    if (first == 0) continue;
    ++later;
    sphere const there = at(first);  // rounded by 2^-50 at most
    REQUIRE(hit_by_regions(t, {there.centre, there.radius + 1e-14}));
  }
  CHECK(hits > 1000);
  CHECK(later > 300);
}

TEST_CASE("oracle: first contacts that are known") {
  triangle const t{{-10, -10, 0}, {10, -10, 0}, {0, 10, 0}};
  CHECK(oracle::impact_time(t, {{0, 0, 4}, 1}, {0, 0, -4}) == 0.75);
  CHECK_FALSE(oracle::hit_before(t, {{0, 0, 4}, 1}, {0, 0, -4}, 0.75));
  CHECK(oracle::hit_before(t, {{0, 0, 4}, 1}, {0, 0, -4}, std::nextafter(0.75, 1)));
  CHECK(oracle::impact_time(t, {{0, 0, 4}, 1}, {0, 0, -9}) == 0.33333333333333337);  // rounded up
  CHECK(oracle::impact_time(t, {{0, 0, 1}, 1}, {1, 0, -1}) == 0);
  CHECK(oracle::impact_time(t, {{0, -20, 1}, 1}, {0, 20, 0}) == 0.5);  // touches the edge where it passes over it
  CHECK(oracle::impact_time(t, {{0, 0, 1e-300}, 0}, {0, 0, -1}) == 1e-300);
  CHECK_FALSE(oracle::hit(t, {{0, 0, 4}, 1}, {0, 0, -std::nextafter(3.0, 0)}));
}

TEST_CASE("oracle: the two formulations agree on small integers, where every tie and degeneracy occurs") {
  std::mt19937 random(1);
  auto const coordinate = [&](int range) {
    return static_cast<double>(random() % (2u * static_cast<unsigned>(range) + 1)) - range;
  };
  int hits = 0, degenerate = 0;
  for (int i = 0; i < 20000; ++i) {
    int const range = 1 + i % 4;
    auto const any = [&] { return point{coordinate(range), coordinate(range), coordinate(range)}; };
    triangle const t{any(), any(), any()};
    sphere const s{any(), static_cast<double>(random() % 4) / 2};
    auto const nearest = oracle::closest(t, s.centre);
    rational const squared = squared_distance_by_regions(t, s.centre);
    CAPTURE(i);
    REQUIRE(oracle::hit(t, s) == hit_by_regions(t, s));
    REQUIRE(nearest.distance == doctest::Approx(std::sqrt(static_cast<double>(squared))).epsilon(1e-15));
    REQUIRE(oracle::depth(t, s) == doctest::Approx(s.radius - nearest.distance).epsilon(1e-15));
    REQUIRE(oracle::closest(t, nearest.on_triangle).distance < 1e-14);
    REQUIRE(std::hypot(nearest.offset.x, nearest.offset.y, nearest.offset.z) == doctest::Approx(nearest.distance));
    triangle const other{t.b, any(), t.c};
    rational const other_squared = squared_distance_by_regions(other, s.centre);
    REQUIRE(oracle::compare_distances(t, other, s.centre) == (squared < other_squared ? -1 : squared > other_squared));
    hits += oracle::hit(t, s);
    degenerate += (nearest.features & (nearest.features - 1)) != 0;
  }
  CHECK(hits > 2000);
  CHECK(degenerate > 100);
}

TEST_CASE("oracle: the two formulations agree on random floats and doubles of every magnitude, tangent to an ulp") {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    bool const single = i % 2 == 0;
    unsigned const spread = i % 3 == 0 ? 0 : 40;  // exponents all over the place need the long integers
    int const size = static_cast<int>(random() % 200) - 100;
    auto const number = [&] {
      double const value = std::ldexp(uniform(random), size + (spread ? static_cast<int>(random() % spread) : 0));
      return single ? static_cast<float>(value) : value;
    };
    auto const any = [&] { return point{number(), number(), number()}; };
    triangle t{any(), any(), any()};
    if (i % 7 == 0) t.c = t.b;
    if (i % 49 == 0) t.b = t.a;
    sphere s{any(), 0};
    s.radius = oracle::closest(t, s.centre).distance;
    if (single) s.radius = static_cast<float>(s.radius);
    for (int ulp = -1; ulp <= 1; ++ulp) {
      sphere moved = s;
      if (ulp != 0 && single) moved.radius = std::nextafter(static_cast<float>(s.radius), ulp < 0 ? 0.0f : 1e38f);
      if (ulp != 0 && !single) moved.radius = std::nextafter(s.radius, ulp < 0 ? 0 : 1e300);
      CAPTURE(i);
      REQUIRE(oracle::hit(t, moved) == hit_by_regions(t, moved));
      hits += oracle::hit(t, moved);
    }
  }
  CHECK(hits > 3000);
  CHECK(hits < 6000);
}

TEST_CASE("oracle: the longest numbers of every integer type still fit") {
  std::mt19937 random(4);
  for (int bits : {39, 40, 41, 81, 82, 83})
    for (int i = 0; i < 500; ++i) {
      auto const extreme = [&] {
        return (random() % 2 ? 1 : -1) * (std::ldexp(1, bits) - std::ldexp(1, std::max(0, bits - 53)));
      };
      auto const any = [&] { return point{extreme(), extreme(), extreme()}; };
      triangle const t{{1, any().y, any().z}, any(), any()};  // the 1 keeps the common exponent at 0
      sphere const s{any(), std::abs(extreme())};
      REQUIRE(oracle::hit(t, s) == hit_by_regions(t, s));
    }
}

TEST_CASE("oracle: depth and distance are exact where a subtraction of rounded numbers is not") {
  triangle const t{{-1e8, -1e8, 0}, {1e8, -1e8, 0}, {0, 1e8, 0}};
  CHECK(oracle::depth(t, {{0, 0, 3}, 3.0000000000000004}) == 3.0000000000000004 - 3.0);
  CHECK(oracle::closest(t, {0, 0, 5e-324}).distance == 5e-324);
  CHECK(oracle::closest(t, {0, 0, 5e-324}).features == oracle::face);
  CHECK(oracle::closest(t, {-2e8, -2e8, 0}).features == oracle::vertex_a);
  CHECK(oracle::closest(t, {0, -2e8, 7}).features == oracle::edge_ab);
  CHECK(oracle::hit({{1.7e308, 0, 0}, {0, 1.7e308, 0}, {0, 0, 1.7e308}}, {{0, 0, 0}, 9.82e307}));
  CHECK_FALSE(oracle::hit({{1.7e308, 0, 0}, {0, 1.7e308, 0}, {0, 0, 1.7e308}}, {{0, 0, 0}, 9.81e307}));
}

TEST_CASE("oracle: a scene is the same with and without the box test, and the band brackets the truth") {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  auto const any = [&](float size) {
    return point{size * uniform(random), size * uniform(random), size * uniform(random)};
  };
  std::vector<triangle> triangles;
  std::vector<sphere> spheres;
  for (int i = 0; i < 80; ++i) {
    point const p = any(3);
    auto const near = [&] { return point{p.x + any(1).x, p.y + any(1).y, p.z + any(1).z}; };
    triangles.push_back({near(), near(), near()});
    spheres.push_back({any(3), std::abs(uniform(random))});
  }
  triangles.push_back(triangles[3]);
  triangles.back().b.y = std::numeric_limits<double>::quiet_NaN();
  spheres.push_back({{0, 0, 0}, -1});
  spheres.push_back({{0, 0, 0}, std::numeric_limits<double>::infinity()});
  std::vector<oracle::id_pair> plain;
  for (unsigned s = 0; s < spheres.size(); ++s)
    for (unsigned t = 0; t < triangles.size(); ++t)
      if (oracle::hit(triangles[t], spheres[s])) plain.push_back({s, t});
  auto const exact = oracle::expect(triangles, spheres), banded = oracle::expect(triangles, spheres, 0.05);
  CHECK(exact.exact == plain);
  CHECK(exact.certain == plain);
  CHECK(exact.possible == plain);
  CHECK(banded.exact == plain);
  CHECK(plain.size() > 100);
  CHECK(banded.certain.size() < plain.size());
  CHECK(plain.size() < banded.possible.size());
  CHECK(std::includes(plain.begin(), plain.end(), banded.certain.begin(), banded.certain.end()));
  CHECK(std::includes(banded.possible.begin(), banded.possible.end(), plain.begin(), plain.end()));
}
