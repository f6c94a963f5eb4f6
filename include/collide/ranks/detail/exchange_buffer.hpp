/// \file
/// Items that ranks send to each other, and how they are delivered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/ranks/ranks.hpp>

namespace collide::detail {

/// Items for each rank, or from each: those of rank 0 first, without gaps.
template <class T>
struct exchange_buffer {
  static_assert(std::is_trivially_copyable<T>::value, "collide: what ranks send is plain");

  std::vector<T> items;
  std::vector<std::uint64_t> counts;  ///< for each rank

  void clear(int ranks) {
    items.clear();
    counts.assign(static_cast<std::size_t>(ranks), 0);
  }
};

/// Fills the mail for `ranks`: sort(put) calls put(rank, item) for all items, any number of times each time the same.
/// It is called twice, to count and to place, so nothing is kept but the mail.
template <class T, class Sort>
void fill_exchange_buffer(exchange_buffer<T>& to, int ranks, Sort const& sort) {
  to.clear(ranks);
  std::uint64_t sum = 0;
  sort([&](int rank, T const&) {
    ++to.counts[static_cast<std::size_t>(rank)];
    ++sum;
  });
  std::vector<std::uint64_t> next(to.counts.size(), 0);
  for (std::size_t r = 1; r < next.size(); ++r) next[r] = next[r - 1] + to.counts[r - 1];
  to.items.resize(static_cast<std::size_t>(sum));
  sort([&](int rank, T const& item) {
    to.items[static_cast<std::size_t>(next[static_cast<std::size_t>(rank)]++)] = item;
  });
}

/// Sends `out` and receives `in`. All ranks call it; where memory is short on one, all throw.
template <class Ranks, class T>
void deliver(Ranks const& ranks, exchange_buffer<T> const& out, exchange_buffer<T>& in) {
  together(ranks, [&] { in.clear(ranks.size()); });
  ranks.exchange_counts(out.counts.data(), in.counts.data());
  together(ranks, [&] {
    std::uint64_t sum = 0;
    for (std::uint64_t const n : in.counts) sum += n;
    in.items.resize(static_cast<std::size_t>(sum));
  });
  ranks.exchange(out.items.data(), out.counts.data(), in.items.data(), in.counts.data(), sizeof(T));
}

}  // namespace collide::detail
