/// \file
/// The bytes of a file, the numbers in them, and the lines, words and numbers of a text.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

#include <collide/core/error.hpp>

namespace collide::detail {

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

/// True if a name ends so, in whatever case; `ending` is in lower case.
inline bool has_ending(std::string_view name, std::string_view ending) {
  if (name.size() < ending.size()) return false;
  name.remove_prefix(name.size() - ending.size());
  for (std::size_t i = 0; i < ending.size(); ++i) {
    if (name[i] != ending[i] && !(name[i] >= 'A' && name[i] <= 'Z' && name[i] - 'A' + 'a' == ending[i])) return false;
  }
  return true;
}

/// True if a word is this keyword, in whatever case.
inline bool is_keyword(std::string_view word, std::string_view keyword) {
  return word.size() == keyword.size() && has_ending(word, keyword);
}

/// A text, line by line. Words are what blanks are between. Errors name the file and the line.
class text_lines {
 public:
  /// \param comment  begins what is left out of a line; 0: nothing does. A byte order mark of UTF-8 is left out, too
  text_lines(std::string_view text, std::string const& what, char comment = '\0')
      : left_{text}, what_{what}, comment_{comment} {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (left_.substr(0, mark.size()) == mark) left_.remove_prefix(mark.size());
  }

  /// Goes on to the next line that has a word. False at the end of the text.
  bool next() {
    do {
      if (left_.empty()) return false;
      line_ = left_.substr(0, left_.find('\n'));
      left_.remove_prefix(line_.size() < left_.size() ? line_.size() + 1 : line_.size());
      ++number_;
      if (comment_ != '\0') line_ = line_.substr(0, line_.find(comment_));
    } while (line_.find_first_not_of(" \t\r") == line_.npos);
    return true;
  }

  std::string_view word() {
    line_.remove_prefix(std::min(line_.find_first_not_of(" \t\r"), line_.size()));
    auto const w = line_.substr(0, line_.find_first_of(" \t\r"));
    line_.remove_prefix(w.size());
    return w;
  }

  /// `word` as a number. Fails unless it is one.
  template <class T>
  T number(std::string_view word) const {
    if (word.empty()) fail("a number is missing");
    bool const plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
    char const* const begin = word.data() + (plus ? 1 : 0);
    char const* const end = word.data() + word.size();
    T value{};
    auto done = std::from_chars(begin, end, value);
    if constexpr (std::is_floating_point<T>::value) {
      if (done.ec == std::errc::result_out_of_range) {  // too small is no error
        long double wide = 0;
        done = std::from_chars(begin, end, wide);
        value = static_cast<T>(wide);
      }
    }
    if (done.ec != std::errc() || done.ptr != end) fail(quoted(word) + " is not a number that is expected here");
    return value;
  }

  template <class T>
  T number() {
    return number<T>(word());
  }

  /// Fails unless `word` is this keyword.
  void expect(std::string_view keyword, std::string_view word) const {
    if (is_keyword(word, keyword)) return;
    fail(word.empty() ? quoted(keyword) + " is missing" : quoted(word) + " in place of " + quoted(keyword));
  }

  void expect(std::string_view keyword) { expect(keyword, word()); }

  /// Fails unless all words of the line have been read.
  void expect_end() {
    auto const w = word();
    if (!w.empty()) fail(quoted(w) + " is more than is expected in this line");
  }

  std::string_view left() const { return left_; }
  /// The number of the line, from 1.
  std::size_t line_number() const { return number_; }

  /// Some of `text`, without what is not printed, in quotation marks.
  static std::string quoted(std::string_view text) {
    std::string out = "'";
    for (char const c : text.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (text.size() > 40 ? "...'" : "'");
  }

  [[noreturn]] void fail(std::string const& why) const {
    throw error(what_ + ": line " + std::to_string(number_) + ": " + why);
  }

 private:
  std::string_view left_, line_;
  std::string what_;
  std::size_t number_ = 0;
  char comment_;
};

}  // namespace collide::detail
