/// \file
/// How many blocks a kernel functor is launched with.
#pragma once

#include <cstddef>

namespace collide::detail {

/// Number of blocks that cover `n` items of a kernel functor on the space.
template <class Space, class Body>
std::size_t grid_size(std::size_t n, Body const&) {
  using block = typename Space::template block<Body>;
  constexpr std::size_t per_block = static_cast<std::size_t>(block::num_threads) * block::items;
  return (n + per_block - 1) / per_block;
}

/// Number of blocks that cover `n` items, but no more than are at work at a time, if the space has such a limit: then
/// they take items in turn.
template <class Space, class Body>
std::size_t persistent_grid_size(Space const& space, std::size_t n, Body const& body) {
  std::size_t const most = grid_size<Space>(n, body), wave = space.template max_resident_blocks<Body>();
  return most < wave ? most : wave;
}

}  // namespace collide::detail
