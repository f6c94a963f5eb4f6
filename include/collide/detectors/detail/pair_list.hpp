/// \file
/// Pairs of several queries, one after the other.
#pragma once

#include <cstddef>
#include <utility>

#include <collide/sinks/pairs.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide::detail {

/// Kernel functor of `for_each` over pairs of a part of a mesh that begins with triangle `first`: as pairs of the
/// whole.
struct shift_triangles {
  pair const* from;
  id first;
  pair* to;
  COLLIDE_HD void operator()(std::size_t i) const { to[i] = {from[i].sphere, from[i].triangle + first}; }
};

/// An array of pairs in memory of a space, to which more are appended.
class pair_list {
 public:
  /// Forgets the pairs.
  void clear() { size_ = 0; }

  /// Room for `n` more pairs; returns where.
  template <class Space>
  pair* append(Space const& space, std::size_t n) {
    std::size_t const before = size_;
    if (before + n > memory_.capacity()) {
      buffer<pair> larger;
      pair* const to = make_room(larger, space.resource(), before + n);
      space.for_each(before, copy_pairs{memory_.data(), to});
      space.synchronize();  // the old memory goes
      memory_ = std::move(larger);
    }
    size_ += n;
    return memory_.data() + before;
  }

  pair const* data() const { return memory_.data(); }
  std::size_t size() const { return size_; }

 private:
  buffer<pair> memory_;
  std::size_t size_ = 0;
};

}  // namespace collide::detail
