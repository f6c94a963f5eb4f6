/// \file
/// Spheres from a CSV file.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "csv_table.hpp"

namespace io {

/// Sphere centres x0, y0, z0, x1, ... and one radius each, or no radii if the file has none.
template <class S>
struct sphere_data {
  std::vector<S> xyz;
  std::vector<S> radii;
  bool has_radii = false;
  rounding tally;

  std::size_t size() const { return xyz.size() / 3; }
};

/// Reads spheres from the text of a CSV file with the columns x, y, z and perhaps r; see `csv_table`. Numbers are
/// correctly rounded to `S`. Throws `data_error`, which names file and line, at what is not a number, at a coordinate
/// or radius that is not finite and at a radius below 0. It reads part `part` of `parts` of the rows.
template <class S>
sphere_data<S> read_csv(std::string const& path, std::string_view text, int part = 0, int parts = 1) {
  std::vector<std::string> const names{"x", "y", "z", "r"};
  constexpr std::size_t radius = 3;
  csv_table table(path, text, names, 3);
  table.keep_part(part, parts);
  auto const rows = table.most_rows();
  sphere_data<S> spheres;
  spheres.xyz.reserve(3 * rows);
  spheres.has_radii = table.has(radius);
  if (spheres.has_radii) spheres.radii.reserve(rows);

  S row[4];
  auto const read = [&](std::size_t column) {
    S const value = row[column] = table.number<S>(column, spheres.tally);
    if (!std::isfinite(value)) table.fail("the number in column '" + names[column] + "' is not finite");
    if (column == radius && value < 0) table.fail("negative radius");
  };
  while (table.read_row(read)) {
    spheres.xyz.insert(spheres.xyz.end(), row, row + 3);
    if (spheres.has_radii) spheres.radii.push_back(row[radius]);
  }
  return spheres;
}

}  // namespace io
