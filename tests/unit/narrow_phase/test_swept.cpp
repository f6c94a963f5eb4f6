/// Balls that move: verdicts, first contacts and their times, on the host. 1.4e6 pairs within 4 units in the last place
/// of tangency in four parts, which run side by side.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <collide/karabassi.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation/detail/step/mesh_contact.hpp>

#include "../oracle/scene.hpp"
#include "narrow_phase/near_contact.hpp"
#include "scenes.hpp"

namespace {

using collide::karabassi_swept;
using oracle::point;

std::string const data = TEST_DATA_DIR;

template <class S>
collide::vec3<S> vector(point const& p) {
  return {static_cast<S>(p.x), static_cast<S>(p.y), static_cast<S>(p.z)};
}

/// A triangle and a moving sphere as the library takes them.
template <class S>
struct sweep {
  collide::triangle<S> shape;
  collide::moving_sphere<S> ball;

  sweep(oracle::triangle const& t, oracle::sphere const& s, point const& move)
      : shape{vector<S>(t.a), vector<S>(t.b), vector<S>(t.c)},
        ball{{vector<S>(s.centre), static_cast<S>(s.radius)}, vector<S>(move)} {}
  explicit sweep(tests::near_sweep const& c) : sweep(c.shape, c.ball, c.move) {}
  explicit sweep(oracle::hard_case const& c) : sweep(c.shape, c.ball, c.move) {}

  template <class Precision = collide::exact>
  bool hit() const {
    return karabassi_swept<Precision>::intersects(shape, ball);
  }
  bool hit_in_integers() const {
    using namespace collide::detail;
    return intersects_in_integers(widened(shape), widened(ball), {1, 0});
  }
};

std::vector<oracle::hard_case> hard_cases() { return oracle::read_hard_cases(data + "/swept_f32.csv", true); }

/// The next to no-contact.
template <class S>
constexpr double most_early = sizeof(S) == sizeof(float) ? 0x1p-23 : 0x1p-30;

/// Checks the time, and that the ball is where it touches then.
template <class S>
void check_impact(oracle::triangle const& t, oracle::sphere const& s, point const& move) {
  sweep<S> const made(t, s, move);
  auto const impact = karabassi_swept<>::impact_of(made.shape, made.ball);
  auto const time = static_cast<double>(impact.time);
  CAPTURE(time);
  REQUIRE(time >= 0);
  REQUIRE(time <= 1);
  bool const overlap = oracle::hit(t, s);
  if (overlap) REQUIRE(time == 0);
  REQUIRE_FALSE(oracle::hit_before(t, s, move, time));
  REQUIRE(oracle::hit_by(t, s, move, std::min(1.0, time + most_early<S>)));
  auto const& c = impact.contact;
  REQUIRE(std::abs(c.normal.template cast<double>().norm() - 1) < 1e-6);
  if (overlap) {
    auto const still = collide::karabassi<>::contact_of(made.shape, made.ball);
    REQUIRE(c.point == still.point);
    REQUIRE(c.normal == still.normal);
    REQUIRE(c.depth == still.depth);
    return;
  }
  // the centre is rounded here, so this is no exact comparison
  point const centre{s.centre.x + time * move.x, s.centre.y + time * move.y, s.centre.z + time * move.z};
  double size = 0;
  for (point const& p : {t.a, t.b, t.c, s.centre}) size = std::max({size, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  double const travel = std::hypot(move.x, move.y, move.z);
  auto const closest = oracle::closest(t, centre);
  auto const distance = static_cast<double>(c.distance);
  double const unit = std::numeric_limits<S>::epsilon(), least = 4.0 * std::numeric_limits<S>::denorm_min();
  double const rounding = 4 * unit * distance + 0x1p-48 * (size + travel) + least;
  REQUIRE(std::abs(distance - closest.distance) <= rounding);
  // it gets nearer by no more than it travels until it touches
  REQUIRE(distance >= s.radius * (1 - 4 * unit) - least);
  REQUIRE(distance <= s.radius + most_early<S> * travel + rounding);
  REQUIRE(oracle::closest(t, {c.point.x(), c.point.y(), c.point.z()}).distance <= 8 * unit * (size + travel) + least);
  REQUIRE(std::abs(-c.normal.template cast<double>().dot(vector<double>(closest.offset)) - distance) <= 4 * rounding);
}

/// Checks the time at which a ball of a simulation stops: not late, and no earlier than one that is larger by
/// `most_close` times the size of the problem would have to.
template <class S>
void check_stopping_time(oracle::triangle const& t, oracle::sphere const& s, point const& move) {
  constexpr double most_close = 0x1p-26;
  sweep<S> const made(t, s, move);
  auto const time = static_cast<double>(collide::detail::stopping_time<karabassi_swept<>>::of(made.shape, made.ball));
  CAPTURE(time);
  REQUIRE(time >= 0);
  REQUIRE(time <= 1);
  if (oracle::hit(t, s)) REQUIRE(time == 0);
  REQUIRE_FALSE(oracle::hit_before(t, s, move, time));
  double const size = collide::detail::max_norm(collide::detail::to_local<double>(made.shape, made.ball));
  oracle::sphere const larger{s.centre, s.radius + most_close * size};
  REQUIRE(oracle::hit_by(t, larger, move, std::min(1.0, time + most_early<S>)));
}

template <class S>
void check_verdicts(std::vector<tests::near_sweep> const& cases, bool with_integers) {
  std::size_t wrong = 0, touching = 0;
  for (auto const& c : cases) {
    sweep<S> const made(c);
    bool const right = made.hit() == c.hit && (!with_integers || made.hit_in_integers() == c.hit);
    if (!right && ++wrong <= 5) MESSAGE("wrong: " << tests::describe(c));
    touching += c.hit;
  }
  CHECK(wrong == 0);
  CHECK(touching > cases.size() / 8);
  CHECK(touching < cases.size() * 7 / 8);
}

template <class S>
void check_near_sweeps(unsigned seed, unsigned batches) {
  for (unsigned i = 0; i < batches; ++i) {
    CAPTURE(seed + i);
    check_verdicts<S>(tests::near_sweeps<S>(seed + i, 10000), false);
  }
}

}  // namespace

TEST_CASE("swept: 9e4 pairs of floats within 4 ulp of tangency") { check_near_sweeps<float>(500, 1); }
TEST_CASE("swept: 9e4 pairs of doubles within 4 ulp of tangency") { check_near_sweeps<double>(600, 1); }
TEST_CASE("hunt: swept: 3.6e5 pairs of floats within 4 ulp of tangency") { check_near_sweeps<float>(100, 4); }
TEST_CASE("hunt: swept: another 3.6e5 pairs of floats within 4 ulp of tangency") { check_near_sweeps<float>(200, 4); }
TEST_CASE("hunt: swept: 3.6e5 pairs of doubles within 4 ulp of tangency") { check_near_sweeps<double>(300, 4); }
TEST_CASE("hunt: swept: another 3.6e5 pairs of doubles within 4 ulp of tangency") { check_near_sweeps<double>(400, 4); }

TEST_CASE_TEMPLATE("swept: every hard case, by stages and in integers alone", S, float, double) {
  auto const cases = hard_cases();
  CHECK(cases.size() == 645);
  for (auto const& row : cases) {
    CAPTURE(row.id);
    CAPTURE(row.sub);
    sweep<S> const made(row);
    CHECK(made.hit() == row.hit);
    bool const finite = !std::isinf(row.ball.radius) && !std::isnan(row.ball.radius);
    if (finite && row.ball.radius >= 0) CHECK(made.hit_in_integers() == row.hit);
  }
}

TEST_CASE_TEMPLATE("swept: every tie and degeneracy of small integers, and coordinates of all exponents", S, float,
                   double) {
  check_verdicts<S>(tests::lattice_sweeps<S>(1, 100000), true);
  check_verdicts<S>(tests::mixed_sweeps<S>(2, 2000), false);
}

TEST_CASE_TEMPLATE("swept: precisions other than exact are right unless distance and radius are next to equal", S,
                   float, double) {
  auto const check = [](auto const& c) {
    sweep<S> const made(c);
    auto const l = collide::detail::to_local<double>(made.shape, made.ball);
    double const m = collide::detail::max_norm(l);
    auto const precise = [&](bool hit, double band) {
      bool const less = oracle::hit(c.shape, {c.ball.centre, c.ball.radius - band * m}, c.move),
                 more = oracle::hit(c.shape, {c.ball.centre, c.ball.radius + band * m}, c.move);
      CHECK(hit >= less);
      CHECK(hit <= more);
    };
    precise(made.template hit<collide::single_precision>(), 256 * 0x1p-24);
    precise(made.template hit<collide::double_precision>(), 256 * 0x1p-53 + 0x1p-50);
  };
  for (auto const& row : hard_cases()) {
    CAPTURE(row.id);
    if (row.ball.radius >= 0) check(row);
  }
  for (auto const& c : tests::lattice_sweeps<S>(3, 5000)) {
    CAPTURE(tests::describe(c));
    check(c);
  }
}

TEST_CASE_TEMPLATE("swept: what does not move collides if and only if it does at rest", S, float, double) {
  std::size_t crossed = 0, moved = 0;
  for (bool const single : {true, false}) {
    if (sizeof(S) == sizeof(float) && !single) continue;
    for (auto const& row : oracle::read_hard_cases(data + (single ? "/static_f32.csv" : "/static_f64.csv"), single)) {
      CAPTURE(row.id);
      S const tiny = std::numeric_limits<S>::denorm_min();
      for (double x : {0.0, -0.0, static_cast<double>(tiny), -1000.0 * static_cast<double>(tiny)}) {
        point const move{x, x, 0};
        // where the gap is as small as subnormal numbers, they are a way to go
        bool const expected = x == 0 ? row.hit : oracle::hit(row.shape, row.ball, move);
        crossed += expected != row.hit;
        ++moved;
        sweep<S> const made(row.shape, row.ball, move);
        CHECK(made.hit() == expected);
        auto const same = [&](auto precision) {
          using p = decltype(precision);
          CHECK(made.template hit<p>() == collide::karabassi<p>::intersects(made.shape, made.ball));
        };
        same(collide::single_precision{});
        same(collide::double_precision{});
      }
    }
  }
  CHECK(crossed > 0);
  CHECK(crossed < moved / 100);
}

TEST_CASE_TEMPLATE("swept: the time of impact is never late, and early by little", S, float, double) {
  for (auto const& row : hard_cases()) {
    CAPTURE(row.id);
    if (!row.hit || std::isinf(row.ball.radius)) continue;
    check_impact<S>(row.shape, row.ball, row.move);
    check_stopping_time<S>(row.shape, row.ball, row.move);
  }
  for (auto const& cases : {tests::near_sweeps<S>(500, 1500), tests::lattice_sweeps<S>(4, 20000)})
    for (auto const& c : cases) {
      CAPTURE(tests::describe(c));
      if (!c.hit) continue;
      check_impact<S>(c.shape, c.ball, c.move);
      check_stopping_time<S>(c.shape, c.ball, c.move);
    }
}

TEST_CASE_TEMPLATE("swept: times of impact that are known", S, float, double) {
  auto const time = [](oracle::triangle const& t, oracle::sphere const& s, point const& move) {
    sweep<S> const made(t, s, move);
    REQUIRE(made.hit());
    return static_cast<double>(karabassi_swept<>::time_of_impact(made.shape, made.ball));
  };
  oracle::triangle const t{{-10, -10, 0}, {10, -10, 0}, {0, 10, 0}};
  CHECK(time(t, {{0, 0, 4}, 1}, {0, 0, -4}) == doctest::Approx(0.75).epsilon(most_early<S>));
  CHECK(time(t, {{0, 0, 4}, 1}, {0, 0, -400}) == doctest::Approx(0.0075).epsilon(1e-4));
  CHECK(time(t, {{0, 0, 4}, 0}, {0, 0, -4}) == doctest::Approx(1).epsilon(most_early<S>));
  CHECK(time(t, {{0, 0, 1}, 1}, {0, 0, 1}) == 0);
  CHECK(time(t, {{0, 0, 4}, std::numeric_limits<double>::infinity()}, {0, 0, -4}) == 0);
  CHECK(time(t, {{0, -20, 1}, 1}, {0, 20, 0}) == doctest::Approx(0.5).epsilon(most_early<S>));
}

TEST_CASE_TEMPLATE("swept: ordinary pairs are decided at once, and their times are next to exact", S, float, double) {
  tests::dice roll(7);
  std::size_t by[4] = {0, 0, 0, 0}, hits = 0, rough = 0;
  for (int i = 0; i < 20000; ++i) {
    oracle::triangle const t{roll.in_cube(1), roll.in_cube(1), roll.in_cube(1)};
    auto const drawn = sweep<S>(t, {roll.in_cube(3), roll.uniform(0.1, 1)}, roll.in_cube(2));
    auto const decided = collide::detail::intersects_exact(drawn.shape, drawn.ball);
    ++by[static_cast<int>(decided.decided_by)];
    if (!decided.hit || i % 4 != 0) continue;
    auto const given = [](collide::vec3<S> const& p) { return point{p.x(), p.y(), p.z()}; };
    oracle::triangle const exact_t{given(drawn.shape.a), given(drawn.shape.b), given(drawn.shape.c)};
    oracle::sphere const exact_s{given(drawn.ball.centre), drawn.ball.radius};
    double const late = oracle::impact_time(exact_t, exact_s, given(drawn.ball.displacement)) -
                        collide::detail::conservative_advancement(collide::detail::widened(drawn.shape),
                                                                  collide::detail::widened(drawn.ball));
    ++hits;
    rough += late > 1e-12;
    CHECK(late >= 0);
  }
  CHECK(by[static_cast<int>(collide::detail::stage::double_filter)] < 10);
  CHECK(by[static_cast<int>(collide::detail::stage::exact_integers)] == 0);
  CHECK(hits > 100);
  CHECK(rough < hits / 50);
}

TEST_CASE_TEMPLATE("swept: bad values never collide, and an infinite radius always does", S, float, double) {
  double const nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  double const good[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 3, 0, 0, -2.5, 1};
  auto const made = [](double const* x) {
    auto const at = [&](int i) { return point{x[i], x[i + 1], x[i + 2]}; };
    return sweep<S>({at(0), at(3), at(6)}, {at(9), x[15]}, at(12));
  };
  auto const check = [](sweep<S> const& s, bool hit) {
    CHECK(s.hit() == hit);
    CHECK(s.template hit<collide::single_precision>() == hit);
    CHECK(s.template hit<collide::double_precision>() == hit);
  };
  check(made(good), true);
  for (int i = 0; i < 16; ++i)
    for (double bad : {nan, inf, -inf}) {
      CAPTURE(i);
      CAPTURE(bad);
      double values[16];
      std::copy(good, good + 16, values);
      values[i] = bad;
      check(made(values), i == 15 && bad == inf);
    }
  double values[16];
  std::copy(good, good + 16, values);
  for (double radius : {-1.0, -0x1p-140}) {
    values[15] = radius;
    check(made(values), false);
  }
  values[15] = -0.0;
  check(made(values), false);
  values[14] = -3;
  CHECK(made(values).hit());
}
