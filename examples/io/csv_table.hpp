/// \file
/// CSV files with named columns.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "error.hpp"
#include "number.hpp"
#include "progress.hpp"
#include "rounding.hpp"

namespace io {

/// A CSV file with a header that names the columns, in any order and among others, which are not looked at; read row by
/// row. Lines end in LF or CRLF, the last one may end without. Blanks around a field, quotation marks, blank lines, a
/// byte order mark and a '#' before the header (NumPy writes one) are fine. Every row has as many fields as the header.
/// Throws `data_error`, which names file and line, at anything else.
class csv_table {
 public:
  /// Reads the header of `text`, which is the file `path`. Columns are known by their place in `names`; the first
  /// `required` of them must be there.
  csv_table(std::string const& path, std::string_view text, std::vector<std::string> names, std::size_t required)
      : path_{path},
        text_{text},
        at_{text_.data()},
        end_{text_.data() + text_.size()},
        names_{std::move(names)},
        bar_{"reading " + path, static_cast<double>(text_.size())} {
    read_header(required);
  }

  /// Leaves part `part` of `parts` to be read: the rows that begin in such a part of the text behind the header.
  void keep_part(int part, int parts) {
    auto const size = static_cast<std::size_t>(end_ - at_), n = static_cast<std::size_t>(parts);
    auto const border = [&](std::size_t k) {
      if (k == 0) return at_;
      if (k == n) return end_;
      char const* const near = std::find(at_ + size / n * k + size % n * k / n, end_, '\n');
      return near == end_ ? end_ : near + 1;
    };
    auto const k = static_cast<std::size_t>(part);
    char const *const begin = border(k), *const end = border(k + 1);
    at_ = begin;
    end_ = end;
  }

  /// True if the file has this column.
  bool has(std::size_t column) const { return std::find(columns_.begin(), columns_.end(), column) != columns_.end(); }

  /// A number of rows that the file does not exceed.
  std::size_t most_rows() const { return static_cast<std::size_t>(std::count(at_, end_, '\n')) + 1; }

  /// Calls read(column) for each known column of the next row, in the order of the file; `read` must take the field, by
  /// `field`, `filled_field` or `number`. False at the end of the file.
  template <class Read>
  bool read_row(Read const& read) {
    if (!next_row()) return false;
    row_ = at_;
    more_ = true;
    for (std::size_t const column : columns_) {
      if (!more_) fail("fewer fields than the header has: " + quoted(line()));
      if (column == names_.size()) {
        field();
      } else {
        read(column);
      }
    }
    if (more_) fail("more fields than the header has: " + quoted(line()));
    if (++rows_ % 65536 == 0) bar_.update(static_cast<double>(at_ - text_.data()));
    return true;
  }

  /// Passes over a field; returns what it holds, without quotation marks and blanks around it.
  std::string_view field() {
    skip_blanks();
    char const* const begin = at_;
    if (at_ != end_ && *at_ == '"') {
      // A quotation mark within a field is doubled, so the closing one is the first that stands alone.
      do {
        ++at_;
        while (at_ != end_ && *at_ != '"' && *at_ != '\n') ++at_;
        if (at_ == end_ || *at_ == '\n') fail("a quotation mark is not closed");
        ++at_;
      } while (at_ != end_ && *at_ == '"');
      std::string_view const text(begin + 1, static_cast<std::size_t>(at_ - begin - 2));
      if (!end_of_field()) fail("text after a closing quotation mark");
      return trimmed(text);
    }
    while (at_ != end_ && *at_ != ',' && *at_ != '\n') ++at_;
    std::string_view const text(begin, static_cast<std::size_t>(at_ - begin));
    end_of_field();
    return trimmed(text);
  }

  /// The same for a field that must not be empty.
  std::string_view filled_field(std::size_t column) {
    auto const text = field();
    if (text.empty()) fail("nothing in column '" + names_[column] + "'");
    return text;
  }

  /// Reads a decimal number, correctly rounded to `S`; what that did to it is added to `tally`.
  template <class S>
  S number(std::size_t column, rounding& tally) {
    char const* const begin = at_;
    skip_blanks();
    S value{};
    rounding here;
    char const* const after = read_number(at_, end_, value, here);
    bool const plain = after != at_;
    at_ = after;
    if (!plain || !end_of_field()) {
      at_ = begin;
      auto const text = filled_field(column);
      here = {};
      if (!parse_number(text, value, here)) fail(column, text, "is not a number");
    }
    tally += here;
    return value;
  }

  /// Throws `data_error` for the row that is being read.
  [[noreturn]] void fail(std::string const& what) const {
    throw data_error(path_, static_cast<std::size_t>(std::count(text_.data(), row_, '\n')) + 1, what);
  }

  /// The same for one field of it.
  [[noreturn]] void fail(std::size_t column, std::string_view text, std::string const& what) const {
    fail(quoted(text) + " in column '" + names_[column] + "' " + what);
  }

 private:
  void read_header(std::size_t required) {
    if (!next_row()) throw data_error(path_, "the file is empty");
    row_ = at_;
    if (*at_ == '#') ++at_;
    for (more_ = true; more_;) {
      auto const name = field();
      auto const column = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
      if (column != names_.size() && has(column)) fail("two columns " + quoted(name));
      columns_.push_back(column);
    }
    for (std::size_t c = 0; c < required; ++c) {
      if (!has(c)) fail("no column '" + names_[c] + "' in the header " + quoted(line()));
    }
  }

  /// Skips blank lines; false at the end of the file.
  bool next_row() {
    for (char const* p = at_; p != end_; ++p) {
      if (*p == '\n') {
        at_ = p + 1;
      } else if (*p != ' ' && *p != '\t' && *p != '\r') {
        return true;
      }
    }
    at_ = end_;
    return false;
  }

  void skip_blanks() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
  }

  /// Passes over blanks and the comma or line end after them; false if something else stands there.
  bool end_of_field() {
    skip_blanks();
    if (at_ != end_ && *at_ == ',') {
      ++at_;
      more_ = true;
      return true;
    }
    if (at_ != end_ && *at_ == '\r') ++at_;
    if (at_ != end_ && *at_ != '\n') return false;
    if (at_ != end_) ++at_;
    more_ = false;
    return true;
  }

  /// The line that is being read.
  std::string_view line() const {
    return trimmed(std::string_view(row_, static_cast<std::size_t>(std::find(row_, end_, '\n') - row_)));
  }

  std::string path_;
  std::string_view text_;
  char const* at_;
  char const* end_;
  char const* row_ = nullptr;
  bool more_ = true;  ///< true until the last field of a row has been passed
  std::size_t rows_ = 0;
  std::vector<std::string> names_;
  std::vector<std::size_t> columns_;  ///< of the file: the place in `names_`, or its size for one that is not known
  progress bar_;
};

}  // namespace io
