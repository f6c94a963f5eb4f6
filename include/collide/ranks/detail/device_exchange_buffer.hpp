/// \file
/// Items in memory of a space that ranks send to each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/core/memory.hpp>
#include <collide/query/concepts.hpp>
#include <collide/ranks/ranks.hpp>
#include <collide/spaces/detail/host_array.hpp>

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

/// Fills a buffer for `ranks`: sort(put) calls put(rank, item) for all items. `sort` is called twice, to count and to
/// place, and gives the same both times; so no item is kept but in the buffer.
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

/// Items for each rank, or from each, in memory of a space: those of rank 0 first, without gaps.
template <class T>
class device_exchange_buffer {
  static_assert(std::is_trivially_copyable<T>::value, "collide: what ranks send is plain");

 public:
  std::vector<std::uint64_t> counts;  ///< for each rank

  /// No items, for so many ranks.
  void clear(int ranks) {
    counts.assign(static_cast<std::size_t>(ranks), 0);
    size_ = 0;
  }
  /// Makes room for as many as `counts` says.
  template <class Space>
  T* resize(Space const& space) {
    size_ = static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
    return ensure_capacity(items_, space.resource(), size_);
  }

  std::size_t size() const { return size_; }
  T* data() const { return items_.data(); }

  /// Copies the items to the host, if that does not see them, and waits.
  template <class Space>
  void to_host(Space const& space) {
    ensure_host_capacity(space);
    if constexpr (!Space::host_accessible) space.copy_to_host(on_host_.data(), data(), size_);
  }
  /// Copies them from the host. Waits.
  template <class Space>
  void from_host(Space const& space) {
    if constexpr (!Space::host_accessible) space.copy_from_host(data(), on_host_.data(), size_);
  }
  template <class Space>
  void ensure_host_capacity(Space const& space) {
    if constexpr (!Space::host_accessible) on_host_.resize(space, size_);
    host_ = Space::host_accessible ? data() : on_host_.data();
  }
  T* on_host() const { return host_; }

 private:
  buffer<T> items_;
  std::size_t size_ = 0;
  host_array<T> on_host_;
  T* host_ = nullptr;
};

/// The member of ranks that send from one device's memory to another's; not all have it.
template <class R, class Space>
using ranks_exchange_in_space = decltype(std::declval<R const&>().exchange_in_space(
    std::declval<Space const&>(), static_cast<void const*>(nullptr), static_cast<std::uint64_t const*>(nullptr),
    static_cast<void*>(nullptr), static_cast<std::uint64_t const*>(nullptr), std::size_t{}));
/// The member of those that find out at run time whether they can.
template <class R>
using ranks_takes_device_memory = decltype(std::declval<R const&>().takes_device_memory());

/// The member of those whose messages are in the order of a space's work.
template <class R, class Space>
using ranks_wait_for = decltype(std::declval<R const&>().wait_for(std::declval<Space const&>()));

/// The members of those whose messages from the host travel while the caller does something else.
template <class R>
using ranks_end_exchange = decltype(std::declval<R const&>().end_exchange());

/// Waits for the work of a space where the ranks have a say in it: they know when to give up messages in it that never
/// come, or have messages under way.
template <class Ranks, class Space>
void wait_for_messages([[maybe_unused]] Ranks const& ranks, [[maybe_unused]] Space const& space) {
  if constexpr (is_valid<ranks_wait_for, Ranks, Space>) ranks.wait_for(space);
}

/// How mail of a space goes from rank to rank: in three parts, as a rank can fail in the first and the last alone. All
/// ranks call all of them.
template <class Ranks, class Space>
class device_exchange {
 public:
  device_exchange(Ranks const& ranks, Space const& space) : ranks_{ranks}, space_{space} {}

  /// Makes mail ready to be sent: if it goes by way of the host, it is there. Then it waits.
  template <class T>
  void stage(device_exchange_buffer<T>& out) const {
    if (!is_direct()) out.to_host(space_);
  }

  /// Sends `out`, which has been staged, and receives `in`, which has room; they may travel until `end`. All ranks come
  /// out of it; if something goes wrong on one in the space, that one throws.
  template <class T>
  void send(device_exchange_buffer<T>& out, device_exchange_buffer<T>& in) const {
    if constexpr (can_be_direct) {
      if (is_direct()) {
        return ranks_.exchange_in_space(space_, out.data(), out.counts.data(), in.data(), in.counts.data(), sizeof(T));
      }
    }
    if constexpr (travels) {
      ranks_.begin_exchange(out.on_host(), out.counts.data(), in.on_host(), in.counts.data(), sizeof(T));
    } else {
      ranks_.exchange(out.on_host(), out.counts.data(), in.on_host(), in.counts.data(), sizeof(T));
    }
  }
  /// True if what `send` sends is under way until `end`.
  bool is_under_way() const { return travels && !is_direct(); }
  /// Waits until all is there.
  void end() const {
    if constexpr (travels) {
      if (!is_direct()) ranks_.end_exchange();
    }
  }

  /// Brings what was received to the space.
  template <class T>
  void unstage(device_exchange_buffer<T>& in) const {
    if (!is_direct()) in.from_host(space_);
  }

  /// Makes room for what is received.
  template <class T>
  void expect(device_exchange_buffer<T>& in) const {
    in.resize(space_);
    if (!is_direct()) in.ensure_host_capacity(space_);
  }

 private:
  static constexpr bool travels = is_valid<ranks_end_exchange, Ranks>;
  static constexpr bool can_be_direct = is_valid<ranks_exchange_in_space, Ranks, Space>;

  bool is_direct() const {
    if constexpr (can_be_direct && is_valid<ranks_takes_device_memory, Ranks>) return ranks_.takes_device_memory();
    return can_be_direct;
  }

  Ranks const& ranks_;
  Space const& space_;
};

/// Sends `out` and receives `in`, by way of memory of the host unless the ranks can do without. All ranks call it;
/// where memory is short on one, all throw.
template <class Ranks, class Space, class T>
void deliver(Ranks const& ranks, Space const& space, device_exchange_buffer<T>& out, device_exchange_buffer<T>& in) {
  device_exchange<Ranks, Space> const by(ranks, space);
  together(ranks, [&] { in.clear(ranks.size()); });
  ranks.exchange_counts(out.counts.data(), in.counts.data());
  together(ranks, [&] {
    by.expect(in);
    by.stage(out);
  });
  first_failure failure;
  failure.attempt([&] {
    by.send(out, in);
    by.end();
    by.unstage(in);
  });
  agree(ranks, failure.get());
}

}  // namespace collide::detail
