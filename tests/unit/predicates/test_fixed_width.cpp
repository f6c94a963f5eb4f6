/// The integers of fixed width of the exact verdict: right where they hold, and they hold where they should.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/exact/detail/predicates/exact.hpp>
#include <collide/exact/detail/predicates/fixed_width.hpp>

#include "../oracle/scene.hpp"
#include "narrow_phase/narrow_phase.hpp"
#include "scenes.hpp"

namespace {

/// Checks the verdicts of those that hold; returns how many these are.
template <class S>
std::size_t check_held(std::vector<tests::near_case> const& cases) {
  std::size_t held = 0;
  for (auto const& c : cases) {
    if (!(c.ball.radius >= 0)) continue;
    tests::narrow_case<S> const made(c);
    auto const shape = collide::detail::widened(made.shape);
    auto const ball = collide::detail::widened(made.ball);
    collide::detail::fixed_width_predicate const fixed(shape, ball);
    if (!fixed.fits()) continue;
    ++held;
    bool const hit = fixed.intersects();
    if (hit == c.hit && hit == collide::detail::intersects_in_integers(shape, ball)) continue;
    CAPTURE(tests::describe(c));
    CHECK(hit == c.hit);
  }
  return held;
}

/// The rows of a file of hard cases that are all finite.
std::vector<tests::near_case> hard_cases(char const* file, bool single) {
  std::vector<tests::near_case> rows;
  for (auto const& c : oracle::read_hard_cases(std::string(TEST_DATA_DIR) + file, single)) {
    auto const& [a, b, d] = c.shape;
    double const numbers[] = {
        a.x, a.y, a.z, b.x, b.y, b.z, d.x, d.y, d.z, c.ball.centre.x, c.ball.centre.y, c.ball.centre.z, c.ball.radius};
    bool const finite = std::all_of(std::begin(numbers), std::end(numbers), [](double x) { return std::isfinite(x); });
    if (finite) rows.push_back({c.shape, c.ball, c.hit});
  }
  return rows;
}

bool holds(oracle::triangle const& t, oracle::sphere const& s) {
  tests::narrow_case<double> const made({t, s, false});
  return collide::detail::fixed_width_predicate(made.shape, made.ball).fits();
}

/// True if these hold together: a coordinate of a corner and that of the centre on one axis, an odd number on another,
/// and a radius; and the same with the opposite signs, and on every axis and corner.
bool holds(double corner, double centre, double radius = 0) {
  bool const first = holds({{corner, 0, 0}, {centre, 0, 0}, {centre, 0, 3}}, {{centre, 0, 0}, radius});
  for (double const sign : {1., -1.}) {
    double const p = sign * corner, c = sign * centre;
    oracle::point const at{p, 0, 0}, at_y{0, p, 0}, at_z{0, 0, p}, odd{c, 3, 0}, odd_y{3, c, 0}, odd_z{3, 0, c};
    CHECK(holds({at, odd, odd}, {{c, 0, 0}, radius}) == first);
    CHECK(holds({odd_y, at_y, odd_y}, {{0, c, 0}, radius}) == first);
    CHECK(holds({odd_z, odd_z, at_z}, {{0, 0, c}, radius}) == first);
  }
  return first;
}

}  // namespace

TEST_CASE_TEMPLATE("fixed triangle: near contact, ties, all exponents and the hard cases", S, float, double) {
  constexpr bool single = sizeof(S) == sizeof(float);
  std::size_t const n = 20000;
  auto const near = tests::near_contact<S>(71, n), ties = tests::ties<S>(72, n),
             mixed = tests::mixed_exponents<S>(73, n);
  CHECK(check_held<S>(near) > (single ? 98 : 60) * 9 * n / 100);
  CHECK(check_held<S>(ties) > (single ? 99 : 85) * 3 * n / 100);
  CHECK(check_held<S>(mixed) < 4 * n / 5);  // of 3 n: most go on to what holds everything
  auto const hard = hard_cases(single ? "/static_f32.csv" : "/static_f64.csv", single);
  CHECK(check_held<S>(hard) > hard.size() / 2);
}

TEST_CASE("fixed triangle: at the largest integers that hold") {
  double const largest = 0x1p126, below = std::nextafter(largest, 0), unit = 0x1p73;
  double const far[] = {largest, below, -largest, -below};
  double const near[] = {0, unit, -unit, 511 * unit, 3 * unit, 0x1p31 * unit, largest / 2};
  tests::dice roll(74);
  std::vector<tests::near_case> cases;
  auto const corner = [&] {
    auto const any = [&] { return roll.integer(0, 5) == 0 ? near[roll.integer(0, 6)] : far[roll.integer(0, 3)]; };
    double const x = any(), y = any(), z = any();
    return oracle::point{x, y, z};
  };
  while (cases.size() < 100000) {
    oracle::triangle const t{corner(), corner(), corner()};
    auto const any = [&] { return near[roll.integer(0, 4)]; };
    double const x = any(), y = any(), z = any();
    oracle::point const centre{x, y, z};
    double const distance = std::min(-oracle::depth(t, {centre, 0}), largest);
    for (double const radius :
         {distance, std::nextafter(distance, 0), std::nextafter(distance, largest), 0., largest, below}) {
      oracle::sphere const s{centre, radius};
      cases.push_back({t, s, oracle::hit(t, s)});
    }
  }
  std::size_t const held = check_held<double>(cases);
  CHECK(held > cases.size() / 8);
  CHECK(held < cases.size());
}

TEST_CASE("fixed triangle: what holds") {
  CHECK(holds(0x1p125, 0));
  CHECK_FALSE(holds(0x1p126, 0));  // the 3 beside it is the unit, so this has 127 bits
  CHECK(holds(0x1p125, 0x1p125));  // there are two words for the numbers themselves
  CHECK_FALSE(holds(0x1p126, 0x1p126));
  CHECK(holds(0x1p73, 0, 0x1p73));
  double const long_one = 0x1p126 - 0x1p73;
  CHECK(holds(long_one, long_one));
  CHECK(holds(long_one, 0));
  CHECK_FALSE(holds(long_one, -long_one));  // the difference counts
  CHECK_FALSE(holds(0x1p128, 0));
  CHECK_FALSE(holds(0x1p128, 0x1p128));
  CHECK_FALSE(holds(std::numeric_limits<double>::max(), 0));
  for (double const unit : {0x1p-1074, 0x1p-1022, 0x1p900}) {
    oracle::triangle const t{{unit, 0, 0}, {0, -unit, 0}, {0, 0, 0x1p61 * unit}};
    CHECK(holds(t, {{unit, unit, unit}, unit}));
    CHECK(holds(t, {{unit, unit, unit}, 0x1p63 * unit}));
    if (unit < 1) CHECK_FALSE(holds(t, {{unit, unit, unit}, 0x1p127 * unit}));
  }
  oracle::point const origin{0, 0, 0};
  CHECK(holds({origin, origin, origin}, {origin, 0}));
}
