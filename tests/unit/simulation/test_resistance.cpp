/// Resistance of a medium, against the equation itself: many small steps of the method of Runge and Kutta.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include <collide/effects/detail/resistance.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace {

using collide::detail::resistance_in_step;
using vec = collide::vec3<double>;

vec resisted(vec const& v, vec const& push, double linear, double quadratic) {
  return collide::detail::resisted(v, push, resistance_in_step(linear, quadratic, 1));
}

vec integrated(vec v, vec const& push, double linear, double quadratic, int steps) {
  auto const rate = [&](vec const& u) { return vec(push - u * (linear + quadratic * u.norm())); };
  double const h = 1.0 / steps;
  for (int i = 0; i < steps; ++i) {
    vec const a = rate(v), b = rate(v + a * (h / 2)), c = rate(v + b * (h / 2)), d = rate(v + c * h);
    v += (a + b * 2 + c * 2 + d) * (h / 6);
  }
  return v;
}

double any_size(std::mt19937& engine, double most = 1.5) {
  return std::pow(10, std::uniform_real_distribution<double>(-3, most)(engine));
}

vec any_direction(std::mt19937& engine) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return {uniform(engine), uniform(engine), uniform(engine)};
}

}  // namespace

TEST_CASE("resistance: with and against a push the closed form") {
  std::mt19937 engine(1);
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    double const linear = i % 3 == 0 ? 0 : any_size(engine), quadratic = any_size(engine);
    double const push = i % 7 == 0 ? 0 : any_size(engine), v = any_size(engine) * (i % 2 == 0 ? 1 : -1);
    if (linear + quadratic * (std::abs(v) + push) > 100) continue;
    double const found = resisted({v, 0, 0}, {push, 0, 0}, linear, quadratic).x();
    double const right = integrated({v, 0, 0}, {push, 0, 0}, linear, quadratic, 4000).x();
    worst = std::max(worst, std::abs(found - right) / (std::abs(v) + std::abs(right)));
    vec const slanted = resisted(vec(2, -1, 2) * (v / 3), vec(2, -1, 2) * (push / 3), linear, quadratic);
    worst = std::max(worst, (slanted - vec(2, -1, 2) * (right / 3)).norm() / (std::abs(v) + std::abs(right)));
  }
  CHECK(worst < 1e-9);
}

TEST_CASE("resistance: what is linear is right to rounding, at any rate") {
  for (double const linear : {1e-12, 1e-3, 1.0, 30.0, 600.0, 1e6}) {
    vec const found = resisted({3, -2, 0}, {0, 5, -7}, linear, 0);
    double const left = std::exp(-linear), gained = -std::expm1(-linear) / linear;
    CHECK(std::abs(found.x() - 3 * left) <= 1e-15 * 3 * left);
    CHECK(found.y() == doctest::Approx(-2 * left + 5 * gained).epsilon(4e-15).scale(0));
    CHECK(found.z() == doctest::Approx(-7 * gained).epsilon(1e-15).scale(0));
  }
}

TEST_CASE("resistance: of second order in any direction") {
  std::mt19937 engine(2);
  for (int i = 0; i < 20; ++i) {
    vec const start = any_direction(engine) * 3, push = any_direction(engine) * 5;
    double const linear = i % 2 == 0 ? 0 : 0.5, quadratic = 0.7;
    vec const right = integrated(start, push, linear, quadratic, 4000);
    auto const error = [&](int steps) {
      vec v = start;
      for (int k = 0; k < steps; ++k) v = resisted(v, push / steps, linear / steps, quadratic / steps);
      return (v - right).norm();
    };
    CHECK(error(64) < 3e-3);
    CHECK(error(512) < error(64) / 40);
  }
}

TEST_CASE("resistance: however strong, nothing goes past the terminal velocity, or turns around") {
  std::mt19937 engine(3);
  double most = 0, least = 1;
  for (int i = 0; i < 20000; ++i) {
    vec const v = any_direction(engine) * any_size(engine, 3), push = any_direction(engine) * any_size(engine, 3);
    double const linear = i % 2 == 0 ? 0 : any_size(engine, 5), quadratic = any_size(engine, 5), a = push.norm();
    double const terminal = 2 * a / (linear + std::sqrt(linear * linear + 4 * quadratic * a));
    most = std::max(most, resisted(v, push, linear, quadratic).norm() / std::max(v.norm(), terminal));
    vec const falls = push / a * any_size(engine, 3), after = resisted(falls, push, linear, quadratic);
    most = std::max(most, after.norm() / std::max(falls.norm(), terminal));
    least = std::min(least, after.norm() / std::min(falls.norm(), terminal));
  }
  CHECK(most < 1 + 1e-14);
  CHECK(least > 1 - 1e-14);
}

TEST_CASE("resistance: one medium in place of several resists as they do") {
  using collide::detail::media;
  using collide::detail::medium;
  std::mt19937 engine(4);
  for (int i = 0; i < 100; ++i) {
    vec const v = any_direction(engine) * 3;
    medium const one{any_size(engine), any_size(engine), any_direction(engine)};
    medium const two{any_size(engine), any_size(engine), any_direction(engine)};
    media all(v);
    all.add(one);
    all.add(two);
    auto const resistance = [&](medium const& m) {
      vec const u = v - m.flow;
      return vec(u * (m.linear + m.quadratic * u.norm()));
    };
    vec const together = resistance(one) + resistance(two);
    medium const sum{one.linear + two.linear, one.quadratic + two.quadratic, all.flow()};
    CHECK((resistance(sum) - together).norm() <= 1e-13 * together.norm());
  }
}

TEST_CASE("resistance: where a step changes little, the closed form to rounding") {
  using real = long double;
  std::mt19937 engine(5);
  double worst = 0;
  int gentle = 0;
  for (int i = 0; i < 20000; ++i) {
    double const linear = i % 3 == 0 ? 0 : any_size(engine, -0.3), quadratic = any_size(engine, 1);
    double const push = any_size(engine, 0) * 0.09 / quadratic, v = i % 5 == 0 ? 0 : any_size(engine, 1);
    double const sign = i % 2 == 0 ? 1 : -1;
    resistance_in_step const r(linear, quadratic, 1);
    auto const found = collide::detail::gentle_response(v * v, sign * v * push, push * push, r);
    if (found.margin < 0) continue;
    ++gentle;
    real const h = real(linear) / 2, square = h * h + (v > 0 ? sign : 1) * real(push) * real(quadratic);
    real const root = std::sqrt(std::abs(square));
    real const t = square > 0 ? std::tanh(root) / root : (square < 0 ? std::tan(root) / root : 1);
    real const right = (v + ((v > 0 ? sign : 1) * real(push) - h * v) * t) / (1 + (h + quadratic * v) * t);
    double const got = v * found.of_velocity + (v > 0 ? sign : 1) * push * found.of_push;
    worst = std::max(worst, double(std::abs(got - right) / (v + right)));
  }
  CHECK(gentle > 15000);
  CHECK(worst < 2e-15);
}

TEST_CASE("resistance: some at a time get the same bits as each alone") {
  constexpr int n = 16;
  std::mt19937 engine(6);
  for (int i = 0; i < 2000; ++i) {
    resistance_in_step const r(i % 3 == 0 ? 0 : any_size(engine, 1), i % 7 == 0 ? 0 : any_size(engine, 1), 0.125);
    collide::detail::velocities_in<float, n, true> some;
    collide::vec3<float> before[n], pushed[n];
    vec flow[n];
    for (int k = 0; k < n; ++k) {
      flow[k] = any_direction(engine) * any_size(engine, 0);
      before[k] = (any_direction(engine) * any_size(engine)).cast<float>();
      if (k % 5 == 0) before[k] = flow[k].cast<float>();
      pushed[k] = k % 3 == 0 ? before[k] : before[k] + (any_direction(engine) * any_size(engine, 0)).cast<float>();
      some.set_before(k, flow[k], before[k]);
      some.set_pushed(k, pushed[k]);
    }
    collide::detail::multiversioned([&] { r.quadratic == 0 ? some.ease(r) : some.find(r); });
    some.keep();
    for (int k = 0; k < n; ++k) {
      collide::vec3<float> found;
      some.get(k, found, r);
      CHECK(found == collide::detail::velocity_in(r, flow[k], before[k], pushed[k]));
    }
  }
}
