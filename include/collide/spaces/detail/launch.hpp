/// \file
/// How many blocks a kernel functor is launched with.
#pragma once

#include <cstddef>

namespace collide::detail {

/// Number of blocks that cover `n` items of a kernel functor on the space.
template <class Space, class Kernel>
std::size_t grid_size(std::size_t n, Kernel const&) {
  using block = typename Space::template block<Kernel>;
  constexpr std::size_t per_block = static_cast<std::size_t>(block::num_threads) * block::items;
  return (n + per_block - 1) / per_block;
}

}  // namespace collide::detail
