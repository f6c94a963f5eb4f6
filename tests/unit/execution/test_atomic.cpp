/// Atomic operations, against plain ones.
#include <algorithm>
#include <cstdint>
#include <random>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include <collide/spaces/detail/atomic.hpp>

using namespace collide::detail;

TEST_CASE_TEMPLATE("atomic: threads that add, and look for the least and the largest, lose nothing", U, std::uint32_t,
                   std::uint64_t) {
  std::mt19937 engine(1);
  std::vector<U> values(40000);
  for (auto& v : values) v = static_cast<U>(engine());
  U sum = 0, least = ~U{0}, largest = 0;
  std::uint32_t bits = 0;
  std::vector<unsigned char> seen(values.size(), 0);  // each number is given to one thread
  U next = 0;
  auto const work = [&](std::size_t first) {
    for (std::size_t i = first; i < values.size(); i += 4) {
      fetch_add(&sum, values[i]);
      fetch_min(&least, values[i]);
      fetch_max(&largest, values[i]);
      fetch_or(&bits, std::uint32_t{1} << i % 31);
      ++seen[static_cast<std::size_t>(fetch_add(&next, U{1}))];
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t) threads.emplace_back(work, t);
  for (auto& t : threads) t.join();
  U expected = 0;
  for (U v : values) expected += v;
  CHECK(sum == expected);
  CHECK(least == *std::min_element(values.begin(), values.end()));
  CHECK(largest == *std::max_element(values.begin(), values.end()));
  CHECK(bits == 0x7fffffffu);
  CHECK(load_relaxed(&next) == values.size());
  CHECK(std::all_of(seen.begin(), seen.end(), [](unsigned char n) { return n == 1; }));
}

TEST_CASE("atomic: a thread alone adds in the plain way, within its scope only") {
  std::uint32_t counter = 5;
  CHECK(!single_threaded);
  {
    single_threaded_scope const outer(true);
    CHECK(single_threaded);
    CHECK(fetch_add(&counter, 2u) == 5);
    {
      single_threaded_scope const inner(false);
      CHECK(!single_threaded);
    }
    CHECK(single_threaded);
    bool elsewhere = true;
    std::thread([&] { elsewhere = single_threaded; }).join();
    CHECK(!elsewhere);
  }
  CHECK(!single_threaded);
  CHECK(counter == 7);
}
