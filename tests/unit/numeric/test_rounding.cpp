/// Arithmetic with one rounding an operation.
#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/exact/detail/numeric/rounding.hpp>

using namespace collide::detail;

TEST_CASE_TEMPLATE("rounding: products, quotients, roots and sums are each rounded to nearest, and not fused", T, float,
                   double) {
  using wide = std::conditional_t<std::is_same<T, float>::value, double, long double>;
  std::mt19937 engine(1);
  std::uniform_real_distribution<T> uniform(-10, 10);
  int fused_differs = 0;
  for (int i = 0; i < 20000; ++i) {
    T volatile const a = uniform(engine), b = uniform(engine), c = -a * b;
    if (std::is_same<T, float>::value) {  // of double, long double is not wide enough
      CHECK(mul_rn(T(a), T(b)) == static_cast<T>(wide(a) * wide(b)));
      CHECK(div_rn(T(a), T(b)) == static_cast<T>(wide(a) / wide(b)));
      CHECK(sqrt_rn(std::abs(T(a))) == static_cast<T>(std::sqrt(std::abs(wide(a)))));
    }
    CHECK(mul_rn(T(a), T(b)) + T(c) == 0);  // fused with the sum it would be the rounding of c
    CHECK(fma_rn(T(a), T(b), T(c)) == std::fma(T(a), T(b), T(c)));
    fused_differs += fma_rn(T(a), T(b), T(c)) != 0;
    CHECK(opaque_value(T(a)) == a);
  }
  CHECK(fused_differs > 10000);
}

TEST_CASE_TEMPLATE("rounding: vectors, part by part", T, float, double) {
  collide::vec3<T> const a(1, -2, 3), b(4, 5, -6);
  CHECK(dot(a, b) == -24);
  CHECK(dot_mul_add(a, b) == -24);
  CHECK(cross(a, b) == collide::vec3<T>(-3, 18, 13));
  CHECK(scaled(a, T(2)) == collide::vec3<T>(2, -4, 6));
  CHECK(min(a, b) == collide::vec3<T>(1, -2, -6));
  CHECK(max(a, b) == collide::vec3<T>(4, 5, 3));
  CHECK(max_component(a) == 3);
}

TEST_CASE("rounding: a vector rounded to float and back is a vector of floats") {
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> uniform(-10, 10);
  for (int i = 0; i < 1000; ++i) {
    collide::vec3<double> const x(uniform(engine), uniform(engine), uniform(engine));
    collide::vec3<double> const back = rounded_to<float>(x).cast<double>();
    for (int k = 0; k < 3; ++k) {
      float volatile const rounded = static_cast<float>(x[k]);
      CHECK(back[k] == static_cast<double>(rounded));
    }
    CHECK(rounded_to<double>(x) == x);
  }
}
