/// Numbers, their differences and products, and sums of products, without rounding.
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include <collide/exact/detail/numeric/exact_sum.hpp>

namespace {

using namespace collide::detail;

double value_of_parts(components_view const& parts) {
  double sum = 0;
  for (int i = 0; i < parts.count; ++i)
    sum += std::ldexp(static_cast<double>(parts[i].mantissa), static_cast<int>(parts[i].exponent));
  return sum;
}

}  // namespace

TEST_CASE("exact numbers: floats are widened to what they are") {
  using limits = std::numeric_limits<float>;
  for (float const x : {0.0f, 1.5f, limits::min(), limits::max(), limits::infinity()}) {
    CHECK(widened(x) == static_cast<double>(x));
    CHECK(widened(-x) == -static_cast<double>(x));
  }
  CHECK(widened(limits::denorm_min()) == 0x1p-149);
  CHECK(widened(-0x1.8p-140f) == -0x1.8p-140);
  CHECK(std::signbit(widened(-0.0f)));
  CHECK(std::isnan(widened(limits::quiet_NaN())));
}

TEST_CASE("exact numbers: a difference is one part if 62 bits suffice, else two; what cancels is gone") {
  exact_memory<8, 4> memory;
  exact_numbers table = memory.table();
  auto const difference = [&](double x, double y) {
    table.begin_number();
    table.add(decoded(x));
    table.subtract(decoded(y));
  };
  difference(3, 0x1p-40);
  difference(3, 0x1p-70);
  difference(0x1.fffffffffffffp+1023, 0x1.fffffffffffffp+1023);
  difference(0x1p-1074, 0);
  CHECK(table[0].count == 1);
  CHECK(value_of_parts(table[0]) == 3 - 0x1p-40);
  CHECK(table[1].count == 2);
  CHECK(value_of_parts(table[1]) == 3.0);
  CHECK(table[2].count == 0);
  CHECK(table[3].count == 1);
  CHECK(table[3][0].mantissa == 1);
  CHECK(table[3][0].exponent == -1074);
}

TEST_CASE("exact numbers: a product has at most two parts") {
  exact_memory<8, 5> memory;
  exact_numbers table = memory.table();
  auto const product = [&](double x, double y) {
    table.begin_number();
    table.add_product(decoded(x), decoded(y));
  };
  double const odd = 0x1.fffffffffffffp+0;
  product(3, -5);
  product(odd, -odd);
  product(0, 7);
  product(0x1p-1074, 0x1p-1074);
  CHECK(value_of_parts(table[0]) == -15);
  CHECK(table[1].count == 2);
  CHECK(value_of_parts(table[1]) == -odd * odd);
  exact_products rest;  // odd^2 = 4 - 2^-50 + 2^-104, if odd is 2 - 2^-52
  table.begin_number();
  table.add(decoded(4));
  table.subtract(decoded(0x1p-50));
  table.add(decoded(0x1p-104));
  rest.add(1, 1);
  rest.add(1, 4);
  CHECK(exact_sum::sign_of(table, rest) == 0);
  CHECK(table[2].count == 0);
  CHECK(table[3][0].exponent == -2148);
}

TEST_CASE("exact sums: determinants of small integers, at scales that are far apart") {
  std::mt19937 engine(1);
  std::uniform_int_distribution<int> roll(-3, 3);
  for (int i = 0; i < 2000; ++i) {
    int const scales[3] = {roll(engine) * 300, roll(engine) * 300, roll(engine) * 100};
    std::int64_t x[9];
    exact_memory<9, 9> memory;
    exact_numbers table = memory.table();
    for (int k = 0; k < 9; ++k) {
      x[k] = roll(engine);
      table.begin_number();
      table.add(reduced(x[k], scales[k / 3]));
    }
    std::int64_t const determinant =
        x[0] * (x[4] * x[8] - x[5] * x[7]) + x[1] * (x[5] * x[6] - x[3] * x[8]) + x[2] * (x[3] * x[7] - x[4] * x[6]);
    exact_products sum, square;
    add_determinant(sum, 1, 0, 3, 6);
    add_determinant_squared(square, -1, 0, 3, 6);
    CHECK(exact_sum::sign_of(table, sum) == (determinant > 0) - (determinant < 0));
    CHECK(exact_sum::sign_of(table, square) == -(determinant != 0));
    scaled_double const value = exact_sum::of(table, sum);
    int const scale = scales[0] + scales[1] + scales[2];
    CHECK(std::ldexp(value.value, value.exponent - scale) == static_cast<double>(determinant));
  }
}

TEST_CASE("exact sums: what is left where large products cancel") {
  exact_memory<4, 4> memory;
  exact_numbers table = memory.table();
  for (double const x : {0x1p+900, 0x1p-900, 0x1.8p+100, 1.0}) {
    table.begin_number();
    table.add(decoded(x));
  }
  exact_products sum;
  sum.add(1, 0, 0, 1, 1);  // 1
  sum.add(-1, 3);
  CHECK(exact_sum::sign_of(table, sum) == 0);
  sum.add(-1, 1, 1);  // -2^-1800
  CHECK(exact_sum::sign_of(table, sum) == -1);
  scaled_double const left = exact_sum::of(table, sum);
  CHECK(left.value < 0);
  CHECK(std::ldexp(left.value, left.exponent + 1800) == -1);
  sum.add(2, 0, 2);
  CHECK(exact_sum::sign_of(table, sum) == 1);
  CHECK(exact_sum::of(table, {}).value == 0);
}
