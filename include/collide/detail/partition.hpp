/// \file
/// Brings values into the order of the leading bits of a key.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <collide/config.hpp>

namespace collide::detail {

/// Where each of the parts begins.
struct partition_table {
  static constexpr std::uint32_t bits = 11, parts = 1u << bits;
  std::size_t begin[parts + 1];
};

/// Copies `n` values to `to`, ordered by the leading `partition_table::bits` bits of keys below 2^key_bits; equal ones
/// stay in their order. O(n), two passes.
template <class T, class Key>
void partition(T const* from, T* to, std::size_t n, std::uint32_t key_bits, Key const& key, partition_table& table) {
  std::uint32_t const shift = key_bits > table.bits ? key_bits - table.bits : 0;
  std::fill(table.begin, table.begin + table.parts + 1, std::size_t{0});
  for (std::size_t i = 0; i < n; ++i) ++table.begin[(key(from[i]) >> shift) + 1];
  std::size_t next[table.parts];
  std::size_t sum = 0;
  for (std::uint32_t p = 0; p < table.parts; ++p) {
    next[p] = sum;
    sum += table.begin[p + 1];
    table.begin[p + 1] = sum;
  }
  for (std::size_t i = 0; i < n; ++i) to[next[key(from[i]) >> shift]++] = from[i];
}

}  // namespace collide::detail
