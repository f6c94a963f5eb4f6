/// Pairs in canonical order, against the standard library's sort.
#include <algorithm>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/host.hpp>
#include <collide/sinks/detail/sort_pairs.hpp>

TEST_CASE("sort pairs: few and many, of one sphere and of many") {
  collide::detail::sort_memory memory;
  std::mt19937 engine(1);
  for (std::size_t n : {0u, 1u, 2u, 2047u, 2048u, 2049u, 100000u}) {
    for (std::size_t spheres : {std::size_t{1}, std::size_t{2048}, std::size_t{2049}, std::size_t{1} << 32}) {
      std::vector<collide::pair> pairs(n);
      for (auto& p : pairs) {
        p = {static_cast<collide::id>(engine() % spheres), static_cast<collide::id>(engine() % 1000)};
      }
      auto expected = pairs;
      std::stable_sort(expected.begin(), expected.end(), [](auto const& a, auto const& b) {
        return a.sphere != b.sphere ? a.sphere < b.sphere : a.triangle < b.triangle;
      });
      collide::host const space(n % 2 == 0 ? 1 : 2);
      collide::detail::sort_pairs(space, pairs.data(), n, n + 10, spheres, 1000, memory);
      CHECK(std::equal(pairs.begin(), pairs.end(), expected.begin(),
                       [](auto const& a, auto const& b) { return a.sphere == b.sphere && a.triangle == b.triangle; }));
    }
  }
}
