/// The blocks that kernels are written against: that of one thread, and the tests' own of several, against plain loops.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <collide/spaces/detail/block.hpp>

#include "execution/lockstep.hpp"

namespace {

using serial = collide::detail::serial_block<4, 8>;
using forward = tests::lockstep_block<8, 4, false>;
using reversed = tests::lockstep_block<8, 4, true>;

}  // namespace

TEST_CASE_TEMPLATE("block: work is balanced: each item of each list once", Block, serial, forward, reversed) {
  std::mt19937 engine(1);
  auto const below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(engine() % n); };
  for (int round = 0; round < 200; ++round) {
    Block block(0);
    std::uint32_t const n = 1 + below(Block::num_threads);
    std::uint32_t counts[Block::num_threads] = {};
    std::vector<std::pair<std::uint32_t, std::uint32_t>> expected, taken;
    for (std::uint32_t i = 0; i < n; ++i) {
      counts[i] = 1 + below(20);
      for (std::uint32_t k = 0; k < counts[i]; ++k) {
        if ((10 * i + k) % 3 != 0) expected.emplace_back(10 * i, k);
      }
    }
    typename Block::balance_storage storage;
    int last = 0, after_last = 0;
    block.template for_each_balanced<2>(
        storage, counts, n, [](std::uint32_t i) { return 10 * i; },
        [](std::uint32_t item, std::uint32_t k) { return std::make_pair(item, k); },
        [](std::uint32_t item, auto const& found) { return (item + found.second) % 3 != 0; },
        [&](std::uint32_t, auto const& found) { taken.push_back(found); },
        [&](bool is_last) {
          after_last += last;
          last += is_last;
        });
    std::sort(taken.begin(), taken.end());
    CHECK(taken == expected);
    CHECK(last == 1);
    CHECK(after_last == 0);
  }
}

TEST_CASE_TEMPLATE("block: sums, reductions, counters and rows", Block, serial, forward, reversed) {
  constexpr std::uint32_t n = Block::num_threads;
  Block block(3);
  CHECK(block.index() == 3);

  std::uint32_t values[n], expected[n], sum = 0;
  for (std::uint32_t i = 0; i < n; ++i) values[i] = 7 * i + 1;
  for (std::uint32_t i = 0; i < n; ++i) expected[i] = sum, sum += values[i];
  typename Block::scan_storage scan;
  CHECK(block.scan(scan, values, n) == sum);
  CHECK(std::equal(values, values + n, expected));

  typename Block::template thread_private<int> own;
  std::uint32_t counter = 5, calls = 0;
  block.for_each_thread([&](int thread_rank) {
    own[thread_rank] = thread_rank * thread_rank;
    CHECK(block.add(counter, 2) == 5 + 2 * calls++);
  });
  CHECK(calls == n);
  typename Block::template reduce_storage<int> reduction;
  CHECK(block.reduce(reduction, own, [](int a, int b) { return std::max(a, b); }) == int(n - 1) * int(n - 1));

  std::vector<float> rows(30), copy(30, 0);
  std::iota(rows.begin(), rows.end(), 0.f);
  float row[3];
  typename Block::template warp_exchange_storage<float, 3> exchange;
  block.load_striped(rows.data(), 4, row);
  block.striped_to_blocked(exchange, row);
  CHECK(std::equal(row, row + 3, rows.begin() + 12));
  block.store_transposed(exchange, copy.data(), 4, row);
  CHECK(std::equal(row, row + 3, copy.begin() + 12));
  CHECK(std::count(copy.begin(), copy.end(), 0.f) == 27);

  typename Block::template staging<float, 30> staging;
  float const* const staged = block.stage(staging, rows.data(), 30);
  CHECK(std::equal(staged, staged + 30, rows.begin()));
}
