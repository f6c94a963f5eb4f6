/// \file
/// Algorithms made of the members of a space, and a search and a sort within a thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include <collide/core/config.hpp>
#include <collide/spaces/detail/block.hpp>

namespace collide::detail {

/// The first number from `low` to before `high` of which is_before is false, as of all behind it; else `high`.
template <class I, class F>
COLLIDE_HD_INLINE I first_not_before(I low, I high, F const& is_before) {
  COLLIDE_NO_UNROLL
  while (low < high) {
    I const middle = low + (high - low) / 2;
    if (is_before(middle)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

/// A heap sort: nothing that calls itself, and no memory.
template <class T, class Less>
COLLIDE_HD void heap_sort(T* values, std::uint32_t n, Less const& comes_before) {
  auto const swap = [&](std::uint32_t i, std::uint32_t k) {
    T const value = values[i];
    values[i] = values[k];
    values[k] = value;
  };
  auto const sift = [&](std::uint32_t root, std::uint32_t end) {
    COLLIDE_NO_UNROLL
    for (std::uint32_t child; (child = 2 * root + 1) < end; root = child) {
      if (child + 1 < end && comes_before(values[child], values[child + 1])) ++child;
      if (!comes_before(values[root], values[child])) return;
      swap(root, child);
    }
  };
  COLLIDE_NO_UNROLL
  for (std::uint32_t root = n / 2; root-- > 0;) sift(root, n);
  COLLIDE_NO_UNROLL
  for (std::uint32_t end = n; end > 1;) {
    swap(0, --end);
    sift(0, end);
  }
}

/// Kernel functor of `for_each` over values.
template <class T>
struct copy_values {
  T const* from;
  T* to;
  COLLIDE_HD void operator()(std::size_t i) const { to[i] = from[i]; }
};

/// Kernel functor: calls f(i) for all i < n if *condition is not 0, each thread for several i.
template <class F>
struct for_each_if_nonzero_kernel {
  static constexpr int items = 1;

  std::uint32_t const* condition;
  std::size_t n;
  F f;
  std::size_t blocks;

  template <class Block>
  struct scratch {};

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>&) const {
    if (*condition == 0) return;
    block.for_each_thread([&](int thread_rank) {
      std::size_t const first = block.index() * Block::num_threads + static_cast<std::size_t>(thread_rank);
      for (std::size_t i = first; i < n; i += blocks * Block::num_threads) f(i);
    });
  }
};

/// Calls f(i) for all i < n if *condition, in memory of the space, is not 0 when it is its turn; meant for what is
/// seldom done.
template <class Space, class F>
void for_each_if_nonzero(Space const& space, std::uint32_t const* condition, std::size_t n, F const& f) {
  if constexpr (Space::host_accessible) {
    if (*condition != 0) space.for_each(n, f);
  } else {
    for_each_if_nonzero_kernel<F> kernel{condition, n, f, 0};
    kernel.blocks = std::min(grid_size<Space>(n, kernel), space.saturating_blocks());
    space.launch(kernel.blocks, kernel);
  }
}

/// Kernel functor that calls f(number of the block), on memory that the host can access.
template <class F>
struct for_each_block_kernel {
  static constexpr int items = 1;

  F f;

  template <class Block>
  struct scratch {};

  template <class Block>
  void operator()(Block& block, scratch<Block>&) const {
    block.for_each_thread([&](int thread_rank) {
      if (thread_rank == 0) f(block.index());
    });
  }
};

/// True of a space on the host whose blocks are one thread each.
template <class Space, class = void>
inline constexpr bool works_alone = false;
template <class Space>
inline constexpr bool works_alone<Space, std::enable_if_t<Space::host_accessible>> =
    Space::template block<for_each_block_kernel<int>>::num_threads == 1;

/// Calls f(i) for all i < n, where each is much work.
template <class Space, class F>
void for_each_block(Space const& space, std::size_t n, F const& f) {
  space.launch(n, for_each_block_kernel<F>{f});
}

/// Makes of each value the sum of those before it, in memory that the host can access.
template <class Space, class U>
void exclusive_scan(Space const& space, U* values, std::size_t n) {
  static_assert(Space::host_accessible, "collide: sums are made on the host");
  constexpr std::size_t max_count = 64, min_count = 1 << 14;  // parts, and values in a part
  std::size_t const parts = std::min({n / min_count + 1, space.saturating_blocks(), max_count}),
                    share = (n + parts - 1) / parts;
  if (parts == 1) {
    std::exclusive_scan(values, values + n, values, U{0});
    return;
  }
  U sums[max_count];
  auto const begin = [&](std::size_t part) { return values + std::min(part * share, n); };
  for_each_block(space, parts, [&](std::size_t p) { sums[p] = std::accumulate(begin(p), begin(p + 1), U{0}); });
  std::exclusive_scan(sums, sums + parts, sums, U{0});
  for_each_block(space, parts, [&](std::size_t p) { std::exclusive_scan(begin(p), begin(p + 1), begin(p), sums[p]); });
}

}  // namespace collide::detail
