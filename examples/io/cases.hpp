/// \file
/// Pairs of a triangle and a sphere from a CSV file, with what the file says of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "csv_table.hpp"

namespace io {

/// Cases in the order of their file.
template <class S>
struct case_data {
  std::vector<std::string> ids;
  std::vector<std::string> families;
  std::vector<S> corners;           ///< nine coordinates per case
  std::vector<S> spheres;           ///< x, y, z and radius per case
  std::vector<S> displacements;     ///< three numbers per case, 0 for those that are not swept
  std::vector<unsigned char> hits;  ///< 0 or 1 per case, or none if the file does not tell
  bool has_hits = false;
  std::size_t swept = 0;  ///< how many cases have a displacement in the file
  rounding tally;
  bool coarse = false;  ///< true if rounding moved a number of some case by more than a thousandth of its radius

  std::size_t size() const { return ids.size(); }
};

/// Reads cases from the text of a CSV file with the columns id, family, ax .. cz (the triangle), px, py, pz and R (the
/// sphere), and perhaps hit (0 or 1), dx, dy and dz (the displacement of a swept case; nothing in any of them in
/// others); see `csv_table`. Numbers are decimal or hexadecimal, nan, inf or -inf, and correctly rounded to `S`. Throws
/// `data_error`, which names file and line, at what is none, and at a number beyond the range of `S`.
template <class S>
case_data<S> read_cases(std::string const& path, std::string_view text) {
  constexpr std::size_t triangle = 9, radius = 12, numbers = 13, id = 13, family = 14, hit = 15, displacement = 16,
                        columns = 19;
  csv_table table(path, text,
                  {"ax", "ay", "az", "bx", "by", "bz", "cx", "cy", "cz", "px", "py", "pz", "R", "id", "family", "hit",
                   "dx", "dy", "dz"},
                  hit);
  case_data<S> cases;
  cases.has_hits = table.has(hit);
  S row[columns];
  std::size_t moves = 0;  // how many of dx, dy and dz there are
  double rounded_by = 0;  // the numbers of the row, at most
  auto const number = [&](std::size_t column, std::string const& text) {
    auto const done = convert(text, row[column]);
    if (done == conversion::not_a_number) table.fail(column, text, "is not a number");
    if (done == conversion::out_of_range) table.fail(column, text, "is beyond the largest number; infinity is inf");
    double nearest = row[column];
    if (done == conversion::rounded) nearest = std::strtod(text.c_str(), nullptr);
    rounded_by = std::max(rounded_by, cases.tally.add(done == conversion::exact, nearest, row[column]));
  };
  auto const read = [&](std::size_t column) {
    if (column < numbers) {
      number(column, std::string(table.filled_field(column)));
    } else if (column == id) {
      auto const text = table.filled_field(column);
      if (text.find_first_of(",\"") != text.npos) table.fail(column, text, "has a comma or a quotation mark");
      cases.ids.emplace_back(text);
    } else if (column == family) {
      cases.families.emplace_back(table.field());
    } else if (column == hit) {
      auto const text = table.filled_field(column);
      if (text != "0" && text != "1") table.fail(column, text, "is neither 0 nor 1");
      cases.hits.push_back(text == "1");
    } else if (std::string const text(table.field()); !text.empty()) {
      number(column, text);
      ++moves;
    }
  };
  auto const read_next = [&] {
    std::fill(row + displacement, row + columns, S(0));
    moves = 0;
    rounded_by = 0;
    return table.read_row(read);
  };
  while (read_next()) {
    if (moves != 0 && moves != 3) table.fail("a swept case needs all of dx, dy and dz");
    cases.swept += moves / 3;
    cases.coarse = cases.coarse || coarse(rounded_by, std::abs(static_cast<double>(row[radius])));
    cases.corners.insert(cases.corners.end(), row, row + triangle);
    cases.spheres.insert(cases.spheres.end(), row + triangle, row + numbers);
    cases.displacements.insert(cases.displacements.end(), row + displacement, row + columns);
  }
  return cases;
}

}  // namespace io
