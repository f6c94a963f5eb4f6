/// \file
/// Sink: all colliding pairs.
#pragma once

#include <collide/sinks/detail/array_in_space.hpp>
#include <collide/spaces/detail/algorithms.hpp>

namespace collide {

/// Every colliding (sphere, triangle) pair, each exactly once. `query` waits once, for their number;
/// where there are more than its memory has room for, it makes room and runs a second time. Memory: 8 bytes for each
/// pair that there is room for, at first as many as there are spheres on the host and a 32nd of that on a GPU, or as
/// many as a sample tells (`reserve` says how many are wanted); and in canonical order what the sort takes.
///
/// The pairs are in memory of the space, which the host may be unable to read: a loop over this object does not
/// compile. Copy them with `to_host()`, or read `data()` in a kernel on the space's stream.
class pairs : public detail::array_in_space<pair> {
 public:
  static constexpr bool keeps_ids_alone = true;

  /// The pairs are kept in memory of the space, as many as there are, in the order `o`.
  explicit pairs(order o = order::unspecified) : order_{o} {}
  /// The pairs are written to the caller's `buffer` (in memory of the space) as long as `capacity` lasts; `total` tells
  /// how many there are all the same. If they do not fit, the first ones are stored in canonical order, else any.
  pairs(pair* buffer, std::size_t capacity, order o = order::unspecified)
      : external_{buffer}, capacity_{capacity}, order_{o}, fixed_{true} {}

  /// How many pairs collide.
  std::uint64_t total() const { return collected_.total(); }
  /// True if all of them are stored.
  bool complete() const { return size() == total(); }

  /// Makes room in memory of `space` for queries of up to so many spheres, and `max_pairs` pairs: they then allocate
  /// nothing.
  template <class Space>
  void reserve(Space const& space, std::size_t spheres, std::size_t max_pairs) {
    if (fixed_ && order_ == order::unspecified) return collected_.reserve(space);
    collected_.reserve(space, spheres, max_pairs);
    if (order_ == order::canonical) collected_.reserve_sort(space);
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    download_ = detail::host_copier<pair>(space);
    if (fixed_ && order_ == order::unspecified) {
      collected_.fill(space, query, external_, capacity_);
    } else {
      collected_.fill(space, query);
    }
    data_ = collected_.data();
    size_ = collected_.size();
    if (order_ == order::unspecified) return;
    collected_.sort(space, query);
    if (!fixed_) return;
    if (size_ > capacity_) size_ = capacity_;
    space.for_each(size_, detail::copy_values<pair>{data_, external_});
    data_ = external_;
  }

 private:
  pair* external_ = nullptr;
  std::size_t capacity_ = 0;
  order order_;
  bool fixed_ = false;
  detail::pair_collector collected_;
};

}  // namespace collide
