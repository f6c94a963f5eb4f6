/// Exponential decay, against long double.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include <collide/exact/detail/numeric/elementary.hpp>

using collide::detail::decay_after;

TEST_CASE("decay: what is left and what is lost, to within two units in the last place") {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> exponent(-60, 9.4);
  auto const error = [](double found, long double right) {
    double const at = static_cast<double>(right);
    return static_cast<double>(std::abs(found - right)) / (std::nextafter(at, 2.) - at);
  };
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    double const z = std::exp2(exponent(engine));
    auto const found = decay_after(z);
    worst = std::max(worst, error(found.lost, -std::expm1(-static_cast<long double>(z))));
    if (z <= 690) worst = std::max(worst, error(found.left, std::exp(-static_cast<long double>(z))));
  }
  CHECK(worst <= 2);
  CHECK(decay_after(0).left == 1);
  CHECK(decay_after(0).lost == 0);
  for (double const z : {691.0, 1e300, std::numeric_limits<double>::infinity()}) {
    CHECK(decay_after(z).left == 0);
    CHECK(decay_after(z).lost == 1);
  }
  CHECK(std::isnan(decay_after(std::numeric_limits<double>::quiet_NaN()).left));
  CHECK(std::isnan(decay_after(std::numeric_limits<double>::quiet_NaN()).lost));
}
