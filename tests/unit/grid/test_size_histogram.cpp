/// Histograms of sizes, against a map.
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <random>

#include <doctest/doctest.h>

#include <collide/broad/detail/grid/size_histogram.hpp>
#include <collide/spaces/detail/block.hpp>

using namespace collide::detail;

TEST_CASE_TEMPLATE("size histogram: four bins an octave, and no size is beyond its bin's end", S, float, double) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> exponent(-120, 120);
  for (int i = 0; i < 10000; ++i) {
    auto const x = static_cast<S>(std::exp2(exponent(engine)));
    std::uint32_t const bin = size_bin(x);
    CHECK(x <= static_cast<S>(bin_end(bin)));
    CHECK(x * S(1.0000002) >= static_cast<S>(bin_end(bin - 1)));  // except for rounding a double to float
    CHECK(size_bin(2 * x) == bin + 4);
  }
  CHECK(size_bin(S(0)) == 0);
  CHECK(size_bin(std::numeric_limits<S>::max()) == size_bin(std::numeric_limits<S>::infinity()));
  CHECK(std::isinf(bin_end(size_bin(std::numeric_limits<S>::max()))));
}

TEST_CASE("size histogram: a block of one thread loses nothing, however few bins it keeps") {
  using block_type = serial_block<64, 256>;
  std::mt19937 engine(2);
  std::uniform_int_distribution<std::uint32_t> any_bin(3, 900), value(0, 5);
  auto const memory = std::make_unique<size_histogram>();
  CHECK(memory->empty());
  std::map<std::uint32_t, std::pair<std::uint64_t, std::uint64_t>> expected;
  block_type block(0);
  block_histogram<block_type> scratch;
  scratch.clear(block);
  for (int i = 0; i < 20000; ++i) {
    std::uint32_t const bin = i % 3 == 0 ? any_bin(engine) : 500u + static_cast<std::uint32_t>(i % 2),
                        v = value(engine);
    scratch.add(block, memory.get(), bin, v);
    ++expected[bin].first;
    expected[bin].second += v;
  }
  scratch.flush(block, memory.get());
  CHECK(memory->first() == static_cast<int>(expected.begin()->first));
  CHECK(memory->last() == static_cast<int>(expected.rbegin()->first));
  bool is_right = true;
  for (std::uint32_t b = 0; b < size_bins; ++b) {
    auto const [count, sum] = expected[b];
    is_right = is_right && memory->counts[b] == count && memory->sums[b] == sum;
  }
  CHECK(is_right);
}
