/// Counters that threads ask together, against plain ones.
#include <cstdint>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/spaces/detail/atomic.hpp>

TEST_CASE("aggregated count: each gets the number before its own, also where it asks a counter twice") {
  constexpr int n = 4;
  std::mt19937 engine(1);
  auto const below = [&](std::uint32_t most) { return static_cast<std::uint32_t>(engine() % most); };
  std::vector<std::uint32_t> counters(10, 0), expected(10, 0);
  for (int round = 0; round < 1000; ++round) {
    std::uint32_t numbers[n], mask = below(16);
    for (auto& number : numbers) number = below(10);
    collide::detail::aggregated_count<n> counts;
    counts.match([&](std::uint32_t k) { return numbers[k]; }, mask);
    counts.add([&](std::uint32_t number) { return &counters[number]; });
    for (std::uint32_t k = 0; k < n; ++k) {
      bool const is_counted = (mask >> k & 1) != 0;
      CHECK(counts.before(k) == (is_counted ? expected[numbers[k]]++ : 0));
    }
  }
  CHECK(counters == expected);
}
