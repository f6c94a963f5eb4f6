/// Decisions on the bits of floating-point numbers.
#include <cmath>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/exact/detail/numeric/float_bits.hpp>

namespace {

/// Numbers of all kinds, from the smallest to the largest.
template <class S>
std::vector<S> rising_numbers() {
  using limits = std::numeric_limits<S>;
  std::vector<S> const positive = {limits::denorm_min(), limits::min(),     S(0.5), S(1), S(3),
                                   limits::max(),        limits::infinity()};
  std::vector<S> all(positive.size());
  for (std::size_t i = 0; i < positive.size(); ++i) all[positive.size() - 1 - i] = -positive[i];
  all.push_back(S(0));
  all.insert(all.end(), positive.begin(), positive.end());
  return all;
}

}  // namespace

TEST_CASE_TEMPLATE("float bits: finite, infinite and valid radii", S, float, double) {
  using namespace collide::detail;
  S const nan = std::numeric_limits<S>::quiet_NaN(), infinity = std::numeric_limits<S>::infinity();
  for (S const x : rising_numbers<S>()) {
    CHECK(is_finite(x) == (std::fabs(x) != infinity));
    CHECK(is_infinite(x) == (x == infinity));
    CHECK(is_valid_radius(x) == (x >= 0));
  }
  CHECK(is_valid_radius(-S(0)));
  for (S const x : {nan, -nan}) {
    CHECK(!is_finite(x));
    CHECK(!is_infinite(x));
    CHECK(!is_valid_radius(x));
    CHECK(!is_finite(collide::vec3<S>(0, x, 0)));
    CHECK(!is_finite(collide::triangle<S>{{0, 0, 0}, {0, 0, 0}, {0, 0, x}}));
  }
}

TEST_CASE_TEMPLATE("float bits: ordered integers sort as the numbers do, and lead back to them", S, float, double) {
  using namespace collide::detail;
  std::vector<S> const numbers = rising_numbers<S>();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0) CHECK(to_ordered_bits(numbers[i - 1]) < to_ordered_bits(numbers[i]));
    CHECK(to_bits(from_ordered_bits<S>(to_ordered_bits(numbers[i]))) == to_bits(numbers[i]));
  }
}

TEST_CASE_TEMPLATE("float bits: the reciprocal power of two brings a number to 1 .. 2", S, float, double) {
  using namespace collide::detail;
  S const largest = std::numeric_limits<S>::max();
  for (S x = std::numeric_limits<S>::min() * S(1.75); x < largest / 8; x *= 8) {
    CHECK(x * inverse_power_of_two(x) == S(1.75));
    CHECK(-x * inverse_power_of_two(-x) == S(-1.75));
  }
  S const most = std::ldexp(S(1), ieee_traits<S>::bias - 1);
  CHECK(inverse_power_of_two(S(0)) == 2 * most);
  CHECK(inverse_power_of_two(std::numeric_limits<S>::denorm_min()) == 2 * most);
  CHECK(inverse_power_of_two(largest) > 0);
}

TEST_CASE_TEMPLATE("float bits: select takes the number that it is told, whatever the other is", S, float, double) {
  using namespace collide::detail;
  S const nan = std::numeric_limits<S>::quiet_NaN();
  CHECK(select(true, S(2), nan) == S(2));
  CHECK(select(false, nan, S(-3)) == S(-3));
  CHECK(saturate(S(-1)) == S(0));
  CHECK(saturate(S(0.25)) == S(0.25));
  CHECK(saturate(S(7)) == S(1));
  CHECK(saturate(nan) == S(0));
}

TEST_CASE_TEMPLATE("float bits: the next number below", S, float, double) {
  using collide::detail::next_below;
  for (S const x : {S(1), S(-1), S(0.7), S(101), S(-100), std::numeric_limits<S>::max()})
    CHECK(next_below(x) == std::nextafter(x, -std::numeric_limits<S>::infinity()));
  CHECK(next_below(S(0)) == -std::numeric_limits<S>::min());
  CHECK(next_below(S(-0.0)) == -std::numeric_limits<S>::min());
}
