/// \file
/// Items in memory of a space that ranks send to each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/concepts.hpp>
#include <collide/detail/execution/host_array.hpp>
#include <collide/memory.hpp>
#include <collide/ranks.hpp>

namespace collide::detail {

/// Items for each rank, or from each, in memory of a space: those of rank 0 first, without gaps.
template <class T>
class space_mail {
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
    return make_room(items_, space.resource(), size_);
  }

  std::size_t size() const { return size_; }
  T* data() const { return items_.data(); }

  /// The items on the host, to be sent.
  template <class Space>
  T const* to_host(Space const& space) {
    if constexpr (Space::host_accessible) {
      return data();
    } else {
      on_host_.resize(space, size_);
      space.copy_to_host(on_host_.data(), data(), size_);
      return on_host_.data();
    }
  }
  /// Where items are received on the host, which `from_host` then takes to the space.
  template <class Space>
  T* host_room(Space const& space) {
    if constexpr (Space::host_accessible) {
      return data();
    } else {
      on_host_.resize(space, size_);
      return on_host_.data();
    }
  }
  template <class Space>
  void from_host(Space const& space) {
    if constexpr (!Space::host_accessible) space.copy_from_host(data(), on_host_.data(), size_);
  }

 private:
  buffer<T> items_;
  std::size_t size_ = 0;
  host_array<T> on_host_;
};

/// The member of ranks that send from one device's memory to another's; not all have it.
template <class R, class Space>
using ranks_exchange_in_space = decltype(std::declval<R const&>().exchange_in_space(
    std::declval<Space const&>(), static_cast<void const*>(nullptr), static_cast<std::uint64_t const*>(nullptr),
    static_cast<void*>(nullptr), static_cast<std::uint64_t const*>(nullptr), std::size_t{}));

/// Sends `out` and receives `in`, by way of memory of the host unless the ranks can do without. All ranks call it;
/// where memory is short on one, all throw.
template <class Ranks, class Space, class T>
void deliver(Ranks const& ranks, Space const& space, space_mail<T>& out, space_mail<T>& in) {
  together(ranks, [&] { in.clear(ranks.size()); });
  ranks.exchange_counts(out.counts.data(), in.counts.data());
  together(ranks, [&] { in.resize(space); });
  if constexpr (is_valid<ranks_exchange_in_space, Ranks, Space>) {
    together(ranks, [&] {
      ranks.exchange_in_space(space, out.data(), out.counts.data(), in.data(), in.counts.data(), sizeof(T));
    });
  } else {
    T const* from = nullptr;
    T* to = nullptr;
    together(ranks, [&] {
      from = out.to_host(space);
      to = in.host_room(space);
    });
    ranks.exchange(from, out.counts.data(), to, in.counts.data(), sizeof(T));
    together(ranks, [&] { in.from_host(space); });
  }
}

}  // namespace collide::detail
