/// \file
/// Histograms of sizes over quarter octaves, with a sum of something else for each bin: what the grid is planned from.
#pragma once

#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

/// Bins for all non-negative floats: four per octave.
inline constexpr int size_bins = 1024;

/// The bin of a size; sizes beyond the range of float count as its end.
template <class S>
COLLIDE_HD_INLINE std::uint32_t size_bin(S size) {
  float const x =
      size < S(std::numeric_limits<float>::max()) ? static_cast<float>(size) : std::numeric_limits<float>::max();
  return to_bits(x) >> 21;
}

/// A size that no size in the bin exceeds; +infinity for the last bin, which holds all sizes beyond float.
COLLIDE_HD_INLINE float bin_end(std::uint32_t bin) {
  std::uint32_t const end = (bin + 1) << 21;
  return from_bits<float>(end < ieee_traits<float>::exponent_mask ? end : ieee_traits<float>::exponent_mask);
}

/// A histogram in memory; memory of zeros is an empty one.
struct size_histogram {
  std::uint32_t lowest;   ///< ~bin, of the lowest in use
  std::uint32_t highest;  ///< bin + 1
  std::uint32_t counts[size_bins];
  std::uint64_t sums[size_bins];

  template <class Space>
  static void clear(Space& space, size_histogram* h) {
    space.fill(h, 0, sizeof *h);
  }

  COLLIDE_HD_INLINE void add(std::uint32_t bin, std::uint32_t n, std::uint32_t sum) {
    fetch_add(counts + bin, n);
    if (sum != 0) fetch_add(sums + bin, std::uint64_t{sum});
    fetch_max(&lowest, ~bin);
    fetch_max(&highest, bin + 1);
  }

  COLLIDE_HD int first() const { return static_cast<int>(~lowest); }
  COLLIDE_HD int last() const { return static_cast<int>(highest) - 1; }
  COLLIDE_HD bool empty() const { return highest == 0; }

  /// The end of the bin of the size in the middle; 0 of no sizes.
  float median() const {
    std::uint64_t all = 0, below = 0;
    for (auto const n : counts) all += n;
    for (std::uint32_t b = 0; b < size_bins; ++b) {
      below += counts[b];
      if (2 * below > all) return bin_end(b);
    }
    return 0;
  }
};

/// Counts in scratch memory first, so that a bin in memory is touched once per block. A block of one thread has so few
/// sizes, and most of them alike, that it counts the last ones only.
template <class Block>
struct block_histogram {
  static constexpr int kept = Block::num_threads > 1 ? size_bins : 64;  ///< a power of two

  std::uint32_t counts[std::size_t(kept)], sums[std::size_t(kept)];
  std::uint32_t bins[Block::num_threads > 1 ? 1 : kept];  ///< of one thread: whose counts they are

  COLLIDE_HD_INLINE void clear(Block& block) {
    block.for_each_thread([&](int thread_rank) {
      for (int b = thread_rank; b < kept; b += Block::num_threads) counts[b] = sums[b] = 0;
    });
  }

  /// The sums of 2^16 sizes must fit into 32 bits.
  COLLIDE_HD_INLINE void add(Block& block, size_histogram* to, std::uint32_t bin, std::uint32_t value) {
    if constexpr (Block::num_threads > 1) {
      block.add(counts[bin], 1);
      if (value != 0) block.add(sums[bin], value);
    } else {
      std::uint32_t const place = bin % kept;
      if (counts[place] != 0 && bins[place] != bin) {
        to->add(bins[place], counts[place], sums[place]);
        counts[place] = sums[place] = 0;
      }
      bins[place] = bin;
      ++counts[place];
      sums[place] += value;
    }
  }

  COLLIDE_HD_INLINE void flush(Block& block, size_histogram* to) {
    block.for_each_thread([&](int thread_rank) {
      for (int b = thread_rank; b < kept; b += Block::num_threads) {
        if (counts[b] == 0) continue;
        if constexpr (Block::num_threads > 1) {
          to->add(static_cast<std::uint32_t>(b), counts[b], sums[b]);
        } else {
          to->add(bins[b], counts[b], sums[b]);
        }
      }
    });
  }
};

}  // namespace collide::detail
