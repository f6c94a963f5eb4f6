/// \file
/// An output that keeps pairs, for the tests of what queries are made of.
#pragma once

#include <cstdint>
#include <vector>

#include <collide/core/contact.hpp>

namespace tests {

struct pair_output {
  std::vector<collide::pair>* to;
  std::uint64_t allocate(std::uint64_t n) const { return to->resize(to->size() + n), to->size() - n; }
  template <class Hit>
  void store(std::uint64_t slot, Hit const& hit) const {
    (*to)[static_cast<std::size_t>(slot)] = {hit.sphere, hit.triangle};
  }
};

}  // namespace tests
