/// \file
/// The bytes of a file, and the numbers in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <type_traits>

#include <collide/core/error.hpp>

namespace collide {
namespace detail {

/// All bytes of a file. Throws unless it can be read.
inline std::string bytes_of_file(std::string const& path, std::string const& what) {
  std::ifstream file(path, std::ios::binary);
  std::string all;
  char part[1 << 14];
  while (file.read(part, sizeof part), file.gcount() > 0) all.append(part, static_cast<std::size_t>(file.gcount()));
  if (!file.eof()) throw error(what + ": the file cannot be read");
  return all;
}

/// The number of type T in the bytes from `at` on, all of which are there.
template <class T>
T number_in_bytes(std::string_view bytes, std::size_t at, bool big_endian) {
  using bits_t = std::conditional_t<sizeof(T) <= 4, std::uint32_t, std::uint64_t>;
  bits_t bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bits = static_cast<bits_t>(bits << 8) |
           static_cast<unsigned char>(bytes[big_endian ? at + i : at + sizeof(T) - 1 - i]);
  }
  if constexpr (std::is_integral<T>::value) {
    return static_cast<T>(bits);
  } else {
    T value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
}

}  // namespace detail
}  // namespace collide
