/// \file
/// Numbers in text: read correctly rounded, whatever the locale.
#pragma once

#include <cctype>
#include <cerrno>
#include <cfenv>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace io {

/// Where a number ends that begins at `first`, and its value rounded once, to nearest even, straight to `S`.
/// Too large a number gives an infinity, too small a one a subnormal or zero. Returns `first` if there is no number.
template <class S>
char const* read_number(char const* first, char const* last, S& value) {
  char const* const begin = first != last && *first == '+' ? first + 1 : first;
  if (begin != first && begin != last && *begin == '-') return first;
  auto const result = std::from_chars(begin, last, value);
  if (result.ec == std::errc::invalid_argument) return first;
  if (result.ec == std::errc::result_out_of_range) {  // from_chars does not say to which side
    std::string const text(begin, result.ptr);
    value = static_cast<S>(std::is_same<S, float>::value ? std::strtof(text.c_str(), nullptr)
                                                         : std::strtod(text.c_str(), nullptr));
  }
  return result.ptr;
}

/// True if all of `text` is one number, which goes to `value`.
template <class S>
bool parse_number(std::string_view text, S& value) {
  char const* const last = text.data() + text.size();
  return !text.empty() && read_number(text.data(), last, value) == last;
}

/// How a text became a number.
enum class conversion { exact, rounded, out_of_range, not_a_number };

/// Reads all of `text` as C's strtof and strtod do, which know hexadecimal numbers (0x1.8p-3), inf and nan: rounded
/// once, straight to `S`. Too small a number becomes a subnormal or zero; too large a one is out of range.
template <class S>
conversion convert(std::string const& text, S& value) {
  char* end = nullptr;
  errno = 0;
  std::feclearexcept(FE_INEXACT);
  if constexpr (std::is_same<S, float>::value) {
    value = std::strtof(text.c_str(), &end);
  } else {
    value = std::strtod(text.c_str(), &end);
  }
  bool const inexact = std::fetestexcept(FE_INEXACT) != 0;  // which C promises to be right (annex F.5)
  if (text.empty() || std::isspace(static_cast<unsigned char>(text.front())) != 0 || end != text.data() + text.size()) {
    return conversion::not_a_number;
  }
  if (errno == ERANGE && std::abs(value) > 1) return conversion::out_of_range;
  return inexact ? conversion::rounded : conversion::exact;
}

/// `text` without blanks at its ends.
inline std::string_view trimmed(std::string_view text) {
  auto const first = text.find_first_not_of(" \t\r");
  return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace io
