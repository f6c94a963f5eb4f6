/// \file
/// Rounding of a file's numbers that are read as float or double, and which of the two to take.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "error.hpp"
#include "number.hpp"

namespace io {

/// How many numbers of a text had to be rounded to be values of a scalar type, and by how much.
struct rounding {
  std::size_t numbers = 0;  ///< how many there are
  std::size_t rounded = 0;  ///< how many of them are no values of the type
  double most = 0;          ///< none was moved by more

  /// Counts a number that rounds to `value`, and as a double to `nearest`. Returns by how much at most it was moved.
  template <class S>
  double add(bool exact, double nearest, S value) {
    ++numbers;
    if (exact) return 0;
    ++rounded;
    double const to_double = std::max(std::abs(nearest) * 0x1p-53, std::numeric_limits<double>::denorm_min());
    double const moved = std::isinf(nearest) ? std::numeric_limits<double>::infinity()
                                             : std::abs(nearest - static_cast<double>(value)) + to_double;
    most = std::max(most, moved);
    return moved;
  }

  rounding& operator+=(rounding const& other) {
    numbers += other.numbers;
    rounded += other.rounded;
    most = std::max(most, other.most);
    return *this;
  }
};

/// True if a number that is moved so far can matter to a sphere of this radius.
inline bool coarse(double moved, double radius) { return moved > 1e-3 * radius || std::isinf(moved); }

/// True if `text`, a decimal number, is exactly the double `nearest`, to which it rounds.
inline bool is_exactly(std::string_view text, double nearest) {
  auto const e = std::min(text.find_first_of("eE"), text.size());
  auto const mantissa = text.substr(0, e);
  if (nearest == 0) return mantissa.find_first_of("123456789") == mantissa.npos;
  double const size = std::abs(nearest);
  if (size >= 1e-22 && size < 1e15) {
    // With n decimal places it is a double only if it is a multiple of 2^-n. If it has 15 digits, it then surely is
    // one: two such multiples of 10^-n cannot round to the same double.
    auto const point = std::min(mantissa.find('.') + 1, mantissa.size());  // npos + 1 is 0
    int exponent = 0;
    if (e < text.size()) parse_number(text.substr(e + 1), exponent);
    int const places = (point == 0 ? 0 : static_cast<int>(mantissa.size() - point)) - exponent;
    double const multiple = std::ldexp(size, std::max(places, 0));
    if (multiple != std::trunc(multiple)) return false;
    if (mantissa.size() <= 15) return true;
  }
  double again = 0;
  return convert(std::string(text), again) == conversion::exact;
}

/// `text` correctly rounded to `S`; `nearest` is the double nearest to it.
template <class S>
S round_to(std::string_view text, double nearest) {
  auto value = static_cast<S>(nearest);
  if constexpr (std::is_same<S, float>::value) {
    // Rounding twice is rounding once unless the double lies half-way between two floats.
    std::uint64_t bits = 0;
    std::memcpy(&bits, &nearest, sizeof bits);
    bool const half_way = (bits & 0x1fffffff) == 0x10000000;
    bool const subnormal = std::abs(nearest) < std::numeric_limits<float>::min();
    if (half_way || subnormal) parse_number(text, value);
  }
  return value;
}

/// Where a number ends that begins at `first`, as `read_number` without a tally has it; what rounding it to `S` did is
/// added to `tally`.
template <class S>
char const* read_number(char const* first, char const* last, S& value, rounding& tally) {
  double nearest = 0;
  char const* const end = read_number(first, last, nearest);
  if (end == first) return first;
  std::string_view const text(first, static_cast<std::size_t>(end - first));
  value = round_to<S>(text, nearest);
  tally.add(static_cast<double>(value) == nearest && is_exactly(text, nearest), nearest, value);
  return end;
}

/// True if all of `text` is one number, which goes to `value`; what rounding it did is added to `tally`.
template <class S>
bool parse_number(std::string_view text, S& value, rounding& tally) {
  char const* const last = text.data() + text.size();
  return !text.empty() && read_number(text.data(), last, value, tally) == last;
}

/// The contents of a file, read as float or as double, and a sentence about how many of its numbers that rounded.
template <class AsFloat, class AsDouble>
struct reading {
  std::variant<AsFloat, AsDouble> data;
  std::string roundings;
};

/// Reads as `scalar` says, "float" or "double". If it is empty, then as float, unless that moves a number by more than
/// a thousandth of a radius or a number is beyond the range of float; then as double. `scalar` says afterwards what it
/// was. `read(S{})` gives an object with a `rounding` named `tally`, and `coarse`, true if numbers were moved that far.
template <class Read,
          class Reading = reading<decltype(std::declval<Read>()(float{})), decltype(std::declval<Read>()(double{}))>>
Reading read_as(std::string& scalar, Read const& read) {
  auto const result = [&](auto data, std::string const& why) {
    std::ostringstream about;
    about << (data.tally.rounded == 0 ? "none" : std::to_string(data.tally.rounded)) << " of " << data.tally.numbers
          << " numbers had to be rounded to " << scalar;
    if (data.tally.rounded > 0) about << ", by at most " << data.tally.most;
    if (data.coarse) about << ", more than a thousandth of a radius";
    return Reading{std::move(data), about.str() + why};
  };
  std::ostringstream why;
  if (scalar != "double") {
    bool const free = scalar.empty();
    scalar = "float";
    try {
      auto data = read(float{});
      if (!free || !data.coarse) return result(std::move(data), "");
      why << "; float would move one by " << data.tally.most;
    } catch (data_error const&) {
      if (!free) throw;
      why << "; float cannot hold one";  // or else reading as double says what is wrong
    }
  }
  scalar = "double";
  return result(read(double{}), why.str());
}

}  // namespace io
