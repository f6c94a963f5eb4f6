/// Numbers of twice the digits of a double against numbers of a hundred digits.
#include <random>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <doctest/doctest.h>

#include <collide/exact/detail/numeric/double_double.hpp>

namespace {

using real = boost::multiprecision::cpp_bin_float_100;
using collide::detail::double_double;

real value(double_double const& x) { return real(x.high) + real(x.low); }

/// Two numbers of magnitudes that differ by up to 2^120, now and then next to opposite.
class pairs_of_numbers {
 public:
  double_double x, y;

  void next() {
    x = any();
    y = any();
    if (roll_() % 4 == 0) y = {-x.high, x.low};
  }
  double_double any() {
    double const high = std::ldexp(mantissa_(roll_), static_cast<int>(roll_() % 120) - 60);
    return collide::detail::exact_sum_of(high, std::ldexp(high * mantissa_(roll_), -54));
  }

 private:
  std::mt19937_64 roll_{5};
  std::uniform_real_distribution<double> mantissa_{-1, 1};
};

}  // namespace

TEST_CASE("double_double: sums and products of two doubles lose nothing") {
  pairs_of_numbers numbers;
  for (int i = 0; i < 20000; ++i) {
    numbers.next();
    double const a = numbers.x.high, b = numbers.y.high, larger = std::abs(a) < std::abs(b) ? b : a,
                 smaller = std::abs(a) < std::abs(b) ? a : b;
    REQUIRE(value(collide::detail::exact_sum_of(a, b)) == real(a) + real(b));
    REQUIRE(value(collide::detail::exact_sum_of_ordered(larger, smaller)) == real(a) + real(b));
    REQUIRE(value(collide::detail::exact_product_of(a, b)) == real(a) * real(b));
  }
}

TEST_CASE("double_double: operations have an error of 2^-100") {
  real const error = ldexp(real(1), -100);
  auto const close = [&](double_double const& found, real const& wanted, real const& scale) {
    return std::abs(found.low) <= std::ldexp(std::abs(found.high), -53) && abs(value(found) - wanted) <= error * scale;
  };
  pairs_of_numbers numbers;
  for (int i = 0; i < 20000; ++i) {
    numbers.next();
    double_double const x = numbers.x, y = numbers.y;
    real const p = value(x), q = value(y);
    REQUIRE(close(x + y, p + q, abs(p) + abs(q)));
    REQUIRE(close(x - y, p - q, abs(p) + abs(q)));
    REQUIRE(close(x * y, p * q, abs(p * q)));
    REQUIRE(close(x / y, p / q, abs(p / q)));
    double_double const square = x * x;
    REQUIRE(close(root(square), abs(p), abs(p)));
    REQUIRE((x < y) == (p < q));
  }
}
