/// Algorithms made of the members of a space, against the standard library's.
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/host.hpp>
#include <collide/spaces/detail/algorithms.hpp>

#include "execution/lockstep.hpp"

using namespace collide::detail;

TEST_CASE_TEMPLATE("algorithms: sums of those before each, in one part and in many", U, std::uint32_t, std::uint64_t) {
  collide::host const space;
  std::mt19937 engine(1);
  for (std::size_t n : {0u, 1u, 2u, 16383u, 16384u, 16385u, 100000u, 1500007u}) {
    std::vector<U> values(n), expected(n);
    for (auto& v : values) v = static_cast<U>(engine() % 1000);
    std::exclusive_scan(values.begin(), values.end(), expected.begin(), U{0});
    exclusive_scan(space, values.data(), n);
    CHECK(values == expected);
  }
}

TEST_CASE("algorithms: for_each_block calls each number once") {
  for (std::size_t n : {0u, 1u, 7u, 1000u}) {
    std::vector<int> calls(n, 0);
    for_each_block(collide::host(1), n, [&](std::size_t i) { ++calls[i]; });
    for_each_block(tests::lockstep<8, false>(), n, [&](std::size_t i) { ++calls[i]; });
    CHECK(std::all_of(calls.begin(), calls.end(), [](int c) { return c == 2; }));
  }
}

TEST_CASE("algorithms: in_turn_if_nonzero does all or nothing, one phase after the other") {
  for (std::uint32_t condition : {0u, 1u, 7u}) {
    for (std::size_t n : {0u, 1u, 255u, 10000u}) {
      std::vector<int> calls(n, 0);
      std::size_t sum = 0;
      phase const count{n, [&](std::size_t i) { calls[i] += static_cast<int>(i % 3); }};
      phase const add{2 * n, [&](std::size_t i) { sum += static_cast<std::size_t>(calls[i / 2]); }};
      in_turn_if_nonzero(collide::host(1), &condition, count, add);
      std::size_t expected = 0;
      for (std::size_t i = 0; i < n; ++i) expected += 2 * (i % 3);
      CHECK(sum == (condition != 0 ? expected : 0));
    }
  }
}
