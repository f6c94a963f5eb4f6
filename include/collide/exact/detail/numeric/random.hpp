/// \file
/// Random numbers that are a function of their number.
#pragma once

#include <cstdint>

#include <collide/core/config.hpp>

namespace collide::detail {

/// From 0 to below 1, always the same for a number: splitmix64 by S. Vigna.
COLLIDE_HD_INLINE double random_fraction(std::uint64_t number) {
  std::uint64_t z = (number + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-53;
}

}  // namespace collide::detail
