/// Sine and cosine, against those of long double.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include <collide/exact/detail/numeric/elementary.hpp>

using collide::detail::sin_cos_near_zero;
using collide::detail::sin_cos_of_turns;

TEST_CASE("sin_cos: near zero, to within two units in the last place") {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform(-1, 1), exponent(-40, 0);
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    double const x = 0.7853981633974483 * uniform(engine) * (i % 2 == 0 ? 1 : std::exp2(exponent(engine)));
    auto const found = sin_cos_near_zero(x);
    long double const sine = std::sin(static_cast<long double>(x)), cosine = std::cos(static_cast<long double>(x));
    double const unit = std::nextafter(std::abs(x), 1.) - std::abs(x);
    worst = std::max({worst, static_cast<double>(std::abs(found.sin - sine)) / std::max(unit, 1e-300),
                      static_cast<double>(std::abs(found.cos - cosine)) / 0x1p-53});
  }
  CHECK(worst <= 2);
}

TEST_CASE("sin_cos: turns, exact at quarters") {
  constexpr long double two_pi = 6.283185307179586476925286766559L;
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> uniform(-1000, 1000);
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    double const turns = i % 2 == 0 ? uniform(engine) : uniform(engine) / 1000;
    auto const found = sin_cos_of_turns(turns);
    long double const angle = two_pi * (static_cast<long double>(turns) - std::floor(static_cast<long double>(turns)));
    worst = std::max({worst, static_cast<double>(std::abs(found.sin - std::sin(angle))),
                      static_cast<double>(std::abs(found.cos - std::cos(angle)))});
  }
  CHECK(worst <= 1e-15);
  double const sines[] = {0, 1, 0, -1}, cosines[] = {1, 0, -1, 0};
  for (int quarter = -9; quarter < 9; ++quarter) {
    auto const found = sin_cos_of_turns(quarter / 4.);
    CHECK(found.sin == sines[(quarter + 12) % 4]);
    CHECK(found.cos == cosines[(quarter + 12) % 4]);
  }
  for (double none : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    CHECK(std::isnan(sin_cos_of_turns(none).sin));
    CHECK(std::isnan(sin_cos_of_turns(none).cos));
  }
}
