/// The search for the nearest triangle against the oracle: which it is, how far, where, and the feature.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include <doctest/doctest.h>

#include <collide/narrow/detail/nearest_search.hpp>

#include "../../flush_to_zero.hpp"
#include "narrow_phase/near_contact.hpp"
#include "nearest/point_cases.hpp"

namespace {

using collide::detail::nearest_search;

template <class S>
using triangles = std::vector<collide::triangle<S>>;

template <class S>
constexpr S infinity = std::numeric_limits<S>::infinity();

template <class S>
bool same_bits(S x, S y) {
  return collide::detail::to_bits(x) == collide::detail::to_bits(y);
}

template <class S>
bool same(collide::nearest_triangle<S> const& a, collide::nearest_triangle<S> const& b) {
  bool equal = a.triangle == b.triangle && a.feature == b.feature && a.feature_index == b.feature_index &&
               same_bits(a.distance, b.distance);
  for (int k = 0; k < 3; ++k)
    equal = equal && same_bits(a.point[k], b.point[k]) && same_bits(a.barycentric[k], b.barycentric[k]);
  return equal;
}

template <class Precision = collide::exact, class S>
collide::nearest_triangle<S> search(triangles<S> const& mesh, collide::vec3<S> const& p, S reach = infinity<S>) {
  nearest_search<S, Precision> search(p, reach);
  for (std::size_t i = 0; i < mesh.size(); ++i) search.consider(mesh[i], static_cast<collide::id>(i));
  return search.result();
}

/// The same in a random order, as a tree would: without triangles that are beyond the bound.
template <class S>
collide::nearest_triangle<S> search_shuffled(triangles<S> const& mesh, collide::vec3<S> const& p, tests::dice& roll) {
  std::vector<std::size_t> order(mesh.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(roll.integer(0, static_cast<int>(i) - 1))]);
  nearest_search<S, collide::exact> search(p, infinity<S>);
  for (std::size_t const i : order) {
    auto const& t = mesh[i];
    long double squared = 0;
    for (int k = 0; k < 3; ++k) {
      long double const low = std::min({t.a[k], t.b[k], t.c[k]}), high = std::max({t.a[k], t.b[k], t.c[k]});
      long double const away = std::max({low - p[k], p[k] - high, 0.0L});
      squared += away * away;
    }
    if (squared * (1 - 0x1p-60L) > search.squared_bound()) continue;
    search.consider(t, static_cast<collide::id>(i));
  }
  return search.result();
}

/// The number of the nearest triangle: all that is compared are exact distances.
template <class S>
collide::id nearest_of_oracle(triangles<S> const& mesh, collide::vec3<S> const& p) {
  std::size_t best = 0;
  oracle::triangle shape = tests::to_oracle(mesh[0]);
  for (std::size_t i = 1; i < mesh.size(); ++i) {
    auto const other = tests::to_oracle(mesh[i]);
    if (oracle::compare_distances(other, shape, tests::to_oracle(p)) < 0) best = i, shape = other;
  }
  return static_cast<collide::id>(best);
}

template <class S>
int ulps_between(S x, double exact) {
  auto const e = static_cast<S>(exact);
  if (x == e) return 0;
  return std::nextafter(x, e) == e ? 1 : 2;
}

std::uint32_t bit_of(collide::feature f, std::uint32_t i) {
  return f == collide::feature::face ? 1u : (f == collide::feature::edge ? 2u << i : 16u << i);
}

/// Checks the distance and the place of the nearest triangle. Where coordinates are farther apart than the digits that
/// the oracle has for a place, not where that is.
template <class S>
bool is_measured_right(collide::nearest_triangle<S> const& found, collide::triangle<S> const& t,
                       collide::vec3<S> const& p, bool with_place) {
  auto const exact = oracle::closest(tests::to_oracle(t), tests::to_oracle(p));
  bool right = ulps_between(found.distance, exact.distance) <= 1 &&
               (exact.features & bit_of(found.feature, found.feature_index)) != 0;
  if (!with_place) return right;
  double const place[3] = {exact.on_triangle.x, exact.on_triangle.y, exact.on_triangle.z};
  double sum = 0;
  constexpr double u = std::numeric_limits<S>::epsilon();
  for (int k = 0; k < 3; ++k) {
    double const size = std::max({std::abs(double(t.a[k])), std::abs(double(t.b[k])), std::abs(double(t.c[k]))});
    double const least = std::numeric_limits<S>::denorm_min();
    right = right && std::abs(double(found.point[k]) - place[k]) <= std::max(u * size, 2 * least);
    double const w = found.barycentric[k];
    sum += w;
    right = right && w >= 0 && w <= 1;
  }
  for (int k = 0; k < 3; ++k) {
    double const at = double(found.barycentric[0]) * double(t.a[k]) + double(found.barycentric[1]) * double(t.b[k]) +
                      double(found.barycentric[2]) * double(t.c[k]);
    double const size = std::max({std::abs(double(t.a[k])), std::abs(double(t.b[k])), std::abs(double(t.c[k]))});
    double const least = std::numeric_limits<S>::denorm_min();
    right = right && (std::abs(at - place[k]) <= 4 * u * size + 4 * least);
  }
  return right && std::abs(sum - 1) <= 2 * u;
}

struct tally {
  int cases = 0, wrong_triangle = 0, wrong_measure = 0, depends_on_order = 0;
};

template <class S>
void judge(triangles<S> const& mesh, collide::vec3<S> const& p, tests::dice& roll, tally& all, bool with_place = true) {
  auto const found = search(mesh, p);
  ++all.cases;
  auto const expected = nearest_of_oracle(mesh, p);
  if (found.triangle != expected) {
    if (++all.wrong_triangle < 4) MESSAGE("nearest: " << found.triangle << ", not " << expected);
  } else if (!is_measured_right(found, mesh[expected], p, with_place)) {
    if (++all.wrong_measure < 4) {
      auto const exact = oracle::closest(tests::to_oracle(mesh[expected]), tests::to_oracle(p));
      MESSAGE("distance " << found.distance << " of " << exact.distance << ", feature "
                          << bit_of(found.feature, found.feature_index) << " of " << exact.features << ", at "
                          << found.point.transpose() << " of " << exact.on_triangle.x << " " << exact.on_triangle.y
                          << " " << exact.on_triangle.z << ", weights " << found.barycentric.transpose());
    }
  }
  all.depends_on_order += !same(found, search_shuffled(mesh, p, roll));
}

void check(tally const& all) {
  CHECK(all.cases > 0);
  CHECK(all.wrong_triangle == 0);
  CHECK(all.wrong_measure == 0);
  CHECK(all.depends_on_order == 0);
}

}  // namespace

TEST_CASE_TEMPLATE("nearest: small integers, where distances are equal", S, float, double) {
  tests::dice roll(1);
  tally all;
  for (int i = 0; i < 3000; ++i) {
    auto const corner = [&] {
      return collide::vec3<S>(S(roll.integer(-2, 2)), S(roll.integer(-2, 2)), S(roll.integer(-2, 2)));
    };
    triangles<S> mesh;
    for (int k = 0; k < 6; ++k) mesh.push_back({corner(), corner(), corner()});
    judge<S>(mesh, corner() * S(0.5), roll, all);
  }
  check(all);
}

TEST_CASE_TEMPLATE("nearest: general position, slivers, segments and points", S, float, double) {
  tests::dice roll(2);
  tally all;
  for (int i = 0; i < 2000; ++i) {
    auto const corner = [&](double size) { return tests::from_oracle<S>(roll.in_cube(size)); };
    triangles<S> mesh;
    for (int k = 0; k < 6; ++k) {
      collide::vec3<S> const a = corner(1), b = a + corner(std::pow(10, roll.uniform(-6, 0))),
                             flat = a + (b - a) * S(0.5);
      int const kind = roll.integer(0, 3);
      mesh.push_back({a, b, kind == 0 ? b : (kind == 1 ? flat : (kind == 2 ? flat + corner(1e-6) : corner(1)))});
    }
    judge<S>(mesh, corner(1), roll, all);
    judge<S>(mesh, tests::point_at_surface(mesh, roll, 1), roll, all);
  }
  check(all);
}

namespace {

/// Triangles and a point with coordinates of all exponents, or of one.
template <class S>
struct any_exponents {
  bool mixed;
  triangles<S> mesh;
  collide::vec3<S> point;

  explicit any_exponents(tests::dice& roll) : mixed(roll.integer(0, 1) == 0) {
    auto const most = std::numeric_limits<S>::max_exponent, least = std::numeric_limits<S>::min_exponent - 20;
    int const all_of = roll.integer(least, roll.integer(0, 2) == 0 ? least + 40 : most - 4);
    auto const number = [&] {
      int const exponent = mixed ? roll.integer(least, most - 4) : all_of;
      return static_cast<S>(std::ldexp(roll.integer(0, 2) == 0 ? roll.integer(-2, 2) : roll.uniform(-2, 2), exponent));
    };
    auto const corner = [&] { return collide::vec3<S>(number(), number(), number()); };
    for (int k = 0; k < 3; ++k) mesh.push_back({corner(), corner(), corner()});
    mesh.push_back({mesh[0].b, mesh[0].a, corner()});
    point = corner();
  }
};

}  // namespace

TEST_CASE_TEMPLATE("nearest: coordinates of all exponents", S, float, double) {
  tests::dice roll(3);
  tally all;
  for (int i = 0; i < (sizeof(S) == sizeof(float) ? 300 : 60); ++i) {
    any_exponents<S> const c(roll);
    judge<S>(c.mesh, c.point, roll, all, !c.mixed);
  }
  check(all);
}

TEST_CASE_TEMPLATE("nearest: the same triangle where the processor takes subnormal numbers for zero", S, float,
                   double) {
  tests::dice roll(4);
  int wrong = 0;
  for (int i = 0; i < (sizeof(S) == sizeof(float) ? 1000 : 60); ++i) {
    any_exponents<S> const c(roll);
    auto const expected = search(c.mesh, c.point).triangle;
    tests::flush_to_zero const flushes;
    wrong += search(c.mesh, c.point).triangle != expected;
  }
  CHECK(wrong == 0);
}

TEST_CASE_TEMPLATE("nearest: points around closed meshes, at the origin and far from it", S, float, double) {
  for (double const offset : {0.0, 1e2, 1e5}) {
    CAPTURE(offset);
    tests::dice roll(4);
    tally all;
    auto const mesh = tests::triangles_of(tests::icosphere<S>(1, 1, {offset, offset, offset}));
    for (int i = 0; i < 400; ++i) {
      judge(mesh, tests::point_at_surface(mesh, roll, i % 3), roll, all);
      auto const p = roll.in_cube(i % 2 == 0 ? 1.5 : 100);
      judge(mesh, tests::from_oracle<S>({offset + p.x, offset + p.y, offset + p.z}), roll, all);
    }
    judge(mesh, tests::from_oracle<S>({offset, offset, offset}), roll, all);
    check(all);
  }
}

TEST_CASE_TEMPLATE("hunt: nearest: half a million points at the surface of closed meshes", S, float, double) {
  for (double const offset : {0.0, 1e2, 1e5}) {
    CAPTURE(offset);
    tests::dice roll(12);
    tally all;
    auto const mesh = tests::triangles_of(tests::icosphere<S>(0, 1, {offset, offset, offset}));
    for (int i = 0; i < 83334; ++i) judge(mesh, tests::point_at_surface(mesh, roll, i % 3), roll, all);
    check(all);
  }
}

TEST_CASE_TEMPLATE("nearest: a distance of exactly the reach counts", S, float, double) {
  int within = 0, cases = 0;
  for (auto const& c : tests::ties<S>(5, 2000)) {
    collide::triangle<S> const t{tests::from_oracle<S>(c.shape.a), tests::from_oracle<S>(c.shape.b),
                                 tests::from_oracle<S>(c.shape.c)};
    auto const found =
        search<collide::exact, S>({t}, tests::from_oracle<S>(c.ball.centre), static_cast<S>(c.ball.radius));
    ++cases;
    within += c.hit;
    CHECK((found.triangle == 0) == c.hit);
  }
  CHECK(within > cases / 4);
  CHECK(within < cases);
}

TEST_CASE_TEMPLATE("nearest: what is not finite", S, float, double) {
  constexpr S nan = std::numeric_limits<S>::quiet_NaN();
  collide::triangle<S> const far_away{{5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
  triangles<S> const mesh{{{0, 0, 0}, {nan, 0, 0}, {0, 1, 0}}, far_away, {{0, 0, infinity<S>}, {1, 0, 0}, {0, 1, 0}}};
  CHECK(search<collide::exact, S>(mesh, {0, 0, 0}).triangle == 1);
  CHECK(search<collide::exact, S>(mesh, {0, 0, 0}).distance == 5);
  auto const is_none = [](collide::nearest_triangle<S> const& r) {
    return r.triangle == collide::no_id && r.distance == infinity<S> && std::isnan(r.point.x()) &&
           std::isnan(r.barycentric.z());
  };
  CHECK(is_none(search<collide::exact, S>(mesh, {nan, 0, 0})));
  CHECK(is_none(search<collide::exact, S>(mesh, {0, -infinity<S>, 0})));
  CHECK(is_none(search<collide::exact, S>(mesh, {0, 0, 0}, nan)));
  CHECK(is_none(search<collide::exact, S>(mesh, {0, 0, 0}, S(-1))));
  CHECK(is_none(search<collide::exact, S>(mesh, {0, 0, 0}, std::nextafter(S(5), S(0)))));
  CHECK(is_none(search<collide::exact, S>({}, {0, 0, 0})));
  CHECK(search<collide::exact, S>(mesh, {5, 0, 0}, S(0)).distance == 0);
  CHECK(search<collide::exact, S>(mesh, {5, 0, 0}, S(-0.0)).triangle == 1);
}

TEST_CASE_TEMPLATE("nearest: plain precisions are close", S, float, double) {
  tests::dice roll(6);
  auto const mesh = tests::triangles_of(tests::icosphere<S>(1, 1, {0, 0, 0}));
  for (int i = 0; i < 500; ++i) {
    auto const p = tests::from_oracle<S>(roll.in_cube(2));
    auto const exact = search(mesh, p);
    auto const in_float = search<collide::single_precision>(mesh, p);
    auto const in_double = search<collide::double_precision>(mesh, p);
    CHECK(std::abs(in_float.distance - exact.distance) < S(1e-6));
    CHECK(std::abs(in_double.distance - exact.distance) <= std::numeric_limits<S>::epsilon() * 2);
    CHECK((in_float.point - exact.point).norm() < S(1e-3));
    for (auto const& r : {in_float, in_double}) {
      auto const& t = mesh[r.triangle];
      CHECK((t.a * r.barycentric[0] + t.b * r.barycentric[1] + t.c * r.barycentric[2] - r.point).norm() < S(1e-5));
    }
  }
}
