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

TEST_CASE("algorithms: for_each_if_nonzero does all or nothing") {
  for (std::uint32_t condition : {0u, 1u, 7u}) {
    for (std::size_t n : {0u, 1u, 255u, 10000u}) {
      std::vector<int> calls(n, 0);
      auto* const to = calls.data();
      for_each_if_nonzero(collide::host(1), &condition, n, [to](std::size_t i) { ++to[i]; });
      // the kernel of a device, thread by thread, in fewer blocks than numbers
      auto const count = [to](std::size_t i) { ++to[i]; };
      for_each_if_nonzero_kernel<decltype(count)> const kernel{&condition, n, count, 3};
      tests::lockstep<8, true>().launch(3, kernel);
      CHECK(std::all_of(calls.begin(), calls.end(), [&](int c) { return c == (condition != 0 ? 2 : 0); }));
    }
  }
}
