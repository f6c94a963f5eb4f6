/// \file
/// Sink: how many pairs collide.
#pragma once

#include <collide/sinks/detail/output.hpp>

namespace collide {

/// Counts the colliding pairs, in 64 bits. `query` waits until the number is known.
class count {
 public:
  static constexpr bool keeps_ids_alone = true;

  /// How many pairs collide; 0 before the first query.
  std::uint64_t total() const { return total_; }

  /// Makes room in memory of `space` for queries of any size: they then allocate nothing.
  template <class Space>
  void reserve(Space const& space, std::size_t /*spheres*/, std::size_t /*pairs*/) {
    total_of_.reserve(space);
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    query(detail::output{total_of_.begin(space), nullptr, 0, nullptr});
    total_ = total_of_.end(space);
  }

 private:
  detail::hit_counter_buffer total_of_;
  std::uint64_t total_ = 0;
};

}  // namespace collide
