/// \file
/// The few smallest of many numbers, in order.
#pragma once

#include <cstdint>

#include <collide/core/geometry.hpp>

namespace collide::detail {

/// The first of neighbours in the order of their numbers.
template <std::uint32_t Room>
struct first_neighbours {
  id numbers[Room];
  std::uint32_t places[Room];
  std::uint32_t size = 0;
  bool complete = true;

  /// Once each, also if it is added again.
  COLLIDE_HD_INLINE void add(id number, std::uint32_t place) {
    if (size == Room && number > numbers[Room - 1]) {
      complete = false;
      return;
    }
    std::uint32_t at = size;
    COLLIDE_NO_UNROLL
    while (at > 0 && numbers[at - 1] > number) --at;
    if (at > 0 && numbers[at - 1] == number) return;
    if (size == Room) {
      complete = false;
      --size;
    }
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = size++; k > at; --k) {
      numbers[k] = numbers[k - 1];
      places[k] = places[k - 1];
    }
    numbers[at] = number;
    places[at] = place;
  }
};

}  // namespace collide::detail
