/// Shared by all harnesses: how a property fails.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace fuzz {

/// Ends the program unless the property holds; libFuzzer then keeps the input.
inline void require(bool holds, char const* property) {
  if (holds) return;
  std::fprintf(stderr, "\nthis does not hold: %s\n", property);
  std::abort();
}

}  // namespace fuzz
