/// \file
/// Spheres from a CSV file.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "error.hpp"
#include "number.hpp"
#include "progress.hpp"
#include "text.hpp"

namespace io {

/// Sphere centres x0, y0, z0, x1, ... and one radius each, or no radii if the file has none.
template <class S>
struct sphere_data {
  std::vector<S> xyz;
  std::vector<S> radii;
  bool has_radii = false;

  std::size_t size() const { return xyz.size() / 3; }
};

/// Reads spheres from a CSV file with a header that names the columns x, y, z and perhaps r, in any order and among
/// others, which are not looked at. Lines end in LF or CRLF, the last one may end without. Blanks around a field,
/// quotation marks, blank lines, a byte order mark and a '#' before the header (NumPy writes one) are fine. Every row
/// has as many fields as the header. Numbers are correctly rounded to `S`. Throws `data_error`, which names file and
/// line, at anything else, and at a coordinate or radius that is not finite or a radius below 0.
template <class S>
class csv_reader {
 public:
  static sphere_data<S> read(std::string const& path) {
    text_file const file(path);
    return csv_reader(path, file.view()).read();
  }

 private:
  static constexpr char const* names[] = {"x", "y", "z", "r"};
  static constexpr int other = 4;

  csv_reader(std::string const& path, std::string_view text)
      : path_{path}, text_{text}, at_{text.data()}, end_{text.data() + text.size()} {}

  sphere_data<S> read() {
    read_header();
    auto const rows = static_cast<std::size_t>(std::count(at_, end_, '\n')) + 1;
    sphere_data<S> spheres;
    spheres.xyz.reserve(3 * rows);
    spheres.has_radii = has_radius_;
    if (has_radius_) spheres.radii.reserve(rows);

    progress bar("reading " + path_, static_cast<double>(text_.size()));
    S row[5];
    for (std::size_t i = 1; next_row(); ++i) {
      read_row(row);
      spheres.xyz.insert(spheres.xyz.end(), row, row + 3);
      if (has_radius_) spheres.radii.push_back(row[3]);
      if (i % 65536 == 0) bar.update(static_cast<double>(at_ - text_.data()));
    }
    return spheres;
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

  void read_header() {
    if (!next_row()) throw data_error(path_, "the file is empty");
    row_ = at_;
    if (*at_ == '#') ++at_;
    int found[5] = {};
    for (bool more = true; more;) {
      auto const name = skip_field(more);
      auto const column = static_cast<int>(std::find(names, names + other, name) - names);
      if (column != other && found[column]++ != 0) fail("two columns " + quoted(name));
      columns_.push_back(column);
    }
    for (int c = 0; c < 3; ++c) {
      if (found[c] == 0) fail("no column '" + std::string(names[c]) + "' in the header " + quoted(line()));
    }
    has_radius_ = found[3] != 0;
  }

  /// Reads the row that begins here, the value of each known column into its place.
  void read_row(S* row) {
    row_ = at_;
    bool more = true;
    for (int const column : columns_) {
      if (!more) fail("fewer fields than the header has: " + quoted(line()));
      if (column == other) {
        skip_field(more);
      } else {
        row[column] = number(column, more);
      }
    }
    if (more) fail("more fields than the header has: " + quoted(line()));
  }

  /// Reads the number in the field that begins here, and passes on to the next field, or the next line: then `more` is
  /// false.
  S number(int column, bool& more) {
    char const* const begin = at_;
    skip_blanks();
    S value{};
    char const* const after = read_number(at_, end_, value);
    bool const plain = after != at_;
    at_ = after;
    if (!plain || !end_of_field(more)) {
      at_ = begin;
      auto const field = skip_field(more);
      if (field.empty()) fail("nothing in column '" + std::string(names[column]) + "'");
      if (!parse_number(field, value)) {
        fail(quoted(field) + " in column '" + names[column] + "' is not a number");
      }
    }
    if (!std::isfinite(value)) fail("the number in column '" + std::string(names[column]) + "' is not finite");
    if (column == 3 && value < 0) fail("negative radius");
    return value;
  }

  /// Passes over a field; returns what it holds, without quotation marks and blanks around it.
  std::string_view skip_field(bool& more) {
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
      std::string_view const field(begin + 1, static_cast<std::size_t>(at_ - begin - 2));
      if (!end_of_field(more)) fail("text after a closing quotation mark");
      return trimmed(field);
    }
    while (at_ != end_ && *at_ != ',' && *at_ != '\n') ++at_;
    std::string_view const field(begin, static_cast<std::size_t>(at_ - begin));
    end_of_field(more);
    return trimmed(field);
  }

  void skip_blanks() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
  }

  /// Passes over blanks and the comma or line end after them; false if something else stands there.
  bool end_of_field(bool& more) {
    skip_blanks();
    if (at_ != end_ && *at_ == ',') {
      ++at_;
      more = true;
      return true;
    }
    if (at_ != end_ && *at_ == '\r') ++at_;
    if (at_ != end_ && *at_ != '\n') return false;
    if (at_ != end_) ++at_;
    more = false;
    return true;
  }

  /// The line that is being read.
  std::string_view line() const {
    return trimmed(std::string_view(row_, static_cast<std::size_t>(std::find(row_, end_, '\n') - row_)));
  }

  [[noreturn]] void fail(std::string const& what) const {
    throw data_error(path_, static_cast<std::size_t>(std::count(text_.data(), row_, '\n')) + 1, what);
  }

  std::string const& path_;
  std::string_view text_;
  char const* at_;
  char const* end_;
  char const* row_ = nullptr;
  std::vector<int> columns_;
  bool has_radius_ = false;
};

/// Reads spheres from a CSV file; see `csv_reader`.
template <class S>
sphere_data<S> read_csv(std::string const& path) {
  return csv_reader<S>::read(path);
}

}  // namespace io
