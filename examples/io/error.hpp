/// \file
/// The two ways in which a program ends badly, and how it quotes what it did not understand.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace io {

/// The command line is wrong: exit status 2.
class usage_error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file is wrong, or cannot be read or written: exit status 1.
class data_error : public std::runtime_error {
 public:
  data_error(std::string const& file, std::string const& what) : std::runtime_error(file + ": " + what) {}
  data_error(std::string const& file, std::size_t line, std::string const& what)
      : data_error(file + ':' + std::to_string(line), what) {}
};

/// `text` on one line: no control characters.
inline std::string one_line(std::string_view text) {
  std::string out;
  for (char const c : text) out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

/// `text` in quotation marks, on one line and no longer than a message can bear.
inline std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 60;
  return text.size() <= longest ? '\'' + one_line(text) + '\'' : '\'' + one_line(text.substr(0, longest)) + "...'";
}

}  // namespace io
