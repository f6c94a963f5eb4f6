/// \file
/// Sink: all colliding pairs.
#pragma once

#include <vector>

#include <collide/detail/sink.hpp>

namespace collide {

/// Every colliding (sphere, triangle) pair, each exactly once. `query` waits once, for their number; the first one may
/// run twice, when there are more pairs than it had room for.
class pairs {
 public:
  /// The pairs are kept in memory of the space, as many as there are.
  explicit pairs(order o = order::unspecified) : order_{o} {}
  /// The pairs are written to the caller's `buffer` (in memory of the space) as long as `capacity` lasts; `total` tells
  /// how many there are all the same. Which ones are stored if they do not fit is unspecified.
  pairs(pair* buffer, std::size_t capacity, order o = order::unspecified)
      : external_{buffer}, capacity_{capacity}, order_{o}, fixed_{true} {}

  /// How many pairs collide.
  std::uint64_t total() const { return collected_.total(); }
  /// How many of them are stored.
  std::size_t size() const { return collected_.size(); }
  /// True if all of them are stored.
  bool complete() const { return size() == total(); }

  /// The stored pairs, in memory of the space.
  pair const* data() const { return collected_.data(); }
  pair const* begin() const { return data(); }
  pair const* end() const { return data() + size(); }
  /// A copy of the stored pairs on the host.
  std::vector<pair> to_host() const { return download_(data(), size()); }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    download_ = detail::downloader<pair>(space);
    if (fixed_) {
      collected_.fill(space, query, external_, capacity_);
    } else {
      collected_.fill(space, query);
    }
    if (order_ == order::canonical) collected_.sort(space, query);
  }

 private:
  pair* external_ = nullptr;
  std::size_t capacity_ = 0;
  order order_;
  bool fixed_ = false;
  detail::collector collected_;
  detail::downloader<pair> download_;
};

}  // namespace collide
