/// Shared by the harnesses of the readers.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "examples/io/error.hpp"
#include "examples/io/rounding.hpp"
#include "require.hpp"

namespace fuzz {

/// The bytes of an input as text.
inline std::string_view text(std::uint8_t const* data, std::size_t size) {
  return {reinterpret_cast<char const*>(data), size};
}

/// The result of read(), or nothing where it refuses. Anything else that it throws ends the program.
template <class Read>
auto read_or_refuse(Read const& read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (io::data_error const&) {
    return std::nullopt;
  }
}

template <class S>
bool all_finite(std::vector<S> const& numbers) {
  for (S const x : numbers) {
    if (!std::isfinite(x)) return false;
  }
  return true;
}

/// Checks the same numbers of a text as floats and as doubles: as many, and the tally of the floats tells how
/// many differ, and by how much at most. (`tally` may count more numbers than are kept.)
inline void check_rounding(std::vector<float> const& floats, std::vector<double> const& doubles,
                           io::rounding const& tally) {
  require(floats.size() == doubles.size(), "as many numbers, whatever the scalar type");
  std::size_t differ = 0;
  for (std::size_t i = 0; i < floats.size(); ++i) {
    double const as_float = floats[i];
    if (as_float == doubles[i] || std::isnan(doubles[i])) continue;
    ++differ;
    require(std::abs(as_float - doubles[i]) <= tally.most, "no number was moved by more than the tally says");
  }
  require(differ <= tally.rounded && tally.rounded <= tally.numbers, "the tally counts what was rounded");
}

/// A number as C's %a, or nan or inf.
inline std::string written(double x) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%a", x);
  return buffer;
}

/// A number in decimals that read back the same.
template <class S>
std::string in_decimals(S x) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.17g", static_cast<double>(x));
  return buffer;
}

}  // namespace fuzz
