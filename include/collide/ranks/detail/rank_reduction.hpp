/// \file
/// Sums over ranks that do not overflow in silence.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/core/error.hpp>
#include <collide/ranks/ranks.hpp>

namespace collide::detail {

/// The sums over all ranks of the counts that `read()` returns, as many on each. Throws what that throws, and `error`
/// if a sum does not fit into 64 bits, on all ranks.
template <class Ranks, class Read>
std::vector<std::int64_t> rank_reduction(Ranks const& ranks, Read const& read) {
  constexpr std::uint64_t low = 0xffffffffu;
  std::vector<std::int64_t> counts;
  std::vector<std::uint64_t> mine, all;  // of each count its upper half, with its sign, and its lower half
  together(ranks, [&] {
    counts = read();
    for (std::int64_t const n : counts) {
      mine.push_back(static_cast<std::uint64_t>(n >> 32));
      mine.push_back(static_cast<std::uint64_t>(n) & low);
    }
    all.resize(mine.size());
  });
  ranks.reduce(mine.data(), all.data(), all.size(), reduction::sum);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    auto const upper = static_cast<std::int64_t>(all[2 * i]) + static_cast<std::int64_t>(all[2 * i + 1] >> 32);
    if (upper != static_cast<std::int32_t>(upper)) throw error("collide: a sum over ranks does not fit into 64 bits");
    counts[i] = static_cast<std::int64_t>(static_cast<std::uint64_t>(upper) << 32 | (all[2 * i + 1] & low));
  }
  return counts;
}

}  // namespace collide::detail
