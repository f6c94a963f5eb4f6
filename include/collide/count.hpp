/// \file
/// Sink: how many pairs collide.
#pragma once

#include <collide/detail/sink.hpp>

namespace collide {

namespace detail {

struct add_up {
  std::uint64_t* total;
  COLLIDE_HD_INLINE std::uint64_t reserve(std::uint64_t n) const { return fetch_add(total, n); }
  template <class Hit>
  COLLIDE_HD_INLINE void store(std::uint64_t, Hit const&) const {}
};

}  // namespace detail

/// Counts the colliding pairs, in 64 bits. `query` waits until the number is known.
class count {
 public:
  /// How many pairs collide.
  std::uint64_t total() const { return total_; }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    std::uint64_t* const counter = counter_.reserve(space.resource(), 1);
    space.fill(counter, 0, sizeof *counter);
    query(detail::add_up{counter});
    total_ = space.read(counter);
  }

 private:
  buffer<std::uint64_t> counter_;
  std::uint64_t total_ = 0;
};

}  // namespace collide
