/// Loops that are compiled for several processors.
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/spaces/detail/multiversion.hpp>

TEST_CASE_TEMPLATE("multiversion: runs a loop once, with the bits of a plain one", T, float, double) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<T> uniform(-1, 1);
  std::vector<T> a(1003), b(1003), plain(1003), versioned(1003, 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = uniform(engine);
    b[i] = uniform(engine);
    plain[i] = a[i] * b[i];
    plain[i] = plain[i] + a[i];  // a product and a sum, which must not be fused
  }
  int runs = 0;
  T* const to = versioned.data();
  collide::detail::multiversioned([&] {
    ++runs;
    for (std::size_t i = 0; i < a.size(); ++i) to[i] = a[i] * b[i] + a[i];
  });
  CHECK(runs == 1);
  CHECK(versioned == plain);
}
