/// Sums of what is before, against a loop.
#include <cstdint>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/host.hpp>
#include <collide/sinks/csr.hpp>

TEST_CASE("exclusive sum: as a loop has it, whatever the number of values and of threads") {
  std::mt19937_64 engine(1);
  collide::buffer<unsigned char> temporary;
  for (std::size_t const n : {0, 1, 2, 3, 63, 64, 65, 1000, 1023, 1024, 1025, 4097, 100003}) {
    std::vector<std::uint64_t> values(n);
    for (auto& v : values) v = engine() >> engine() % 64;  // sums wrap around
    std::vector<std::uint64_t> expected;
    std::uint64_t sum = 0;
    for (std::uint64_t const v : values) {
      expected.push_back(sum);
      sum += v;
    }
    for (int const threads : {1, 2, 3, 7}) {
      collide::host const space(threads);
      CHECK(collide::detail::exclusive_sum_bytes(space, n) == 0);
      auto sums = values;
      collide::detail::exclusive_sum(space, sums.data(), n, temporary);
      CHECK((sums == expected));
    }
  }
}
