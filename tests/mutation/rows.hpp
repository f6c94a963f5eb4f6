/// The cases of the mutation check, as make_rows writes them: bits, so that no flag of a compiler changes them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <collide/core/geometry.hpp>

namespace tests {

template <class S>
struct row {
  std::array<S, 13> numbers;  ///< corners, centre, radius
  S hit;                      ///< 1 if the two touch, else 0
  double distance, depth;     ///< exact, rounded once; of finite numbers and a radius not below 0; NaN where not known

  collide::triangle<S> triangle() const { return {at(0), at(3), at(6)}; }
  collide::sphere<S> sphere() const { return {at(9), numbers[12]}; }

 private:
  collide::vec3<S> at(std::size_t i) const { return {numbers[i], numbers[i + 1], numbers[i + 2]}; }
};

/// Four triangles and a point.
template <class S>
struct nearest_row {
  static constexpr std::size_t count = 4;
  enum side : int { outside, inside, none };

  std::array<S, 9 * count + 3> numbers;  ///< corners, point
  double distance;                       ///< of the nearest, exact, rounded once
  unsigned features;                     ///< of the closest point, as the oracle's bits
  int nearest;                           ///< which one it is, of equally near ones the first
  int side;                              ///< of the mesh of the four, if that is closed

  collide::triangle<S> triangle(std::size_t i) const { return {at(9 * i), at(9 * i + 3), at(9 * i + 6)}; }
  collide::vec3<S> point() const { return at(9 * count); }

 private:
  collide::vec3<S> at(std::size_t i) const { return {numbers[i], numbers[i + 1], numbers[i + 2]}; }
};

/// Two triangles.
struct pair_row {
  std::array<double, 18> numbers;
  int meet;  ///< as `oracle::meet` has it

  collide::triangle<double> triangle(std::size_t i) const { return {at(9 * i), at(9 * i + 3), at(9 * i + 6)}; }
  collide::vec3<double> at(std::size_t i) const { return {numbers[i], numbers[i + 1], numbers[i + 2]}; }
};

/// The file of the rows of `S`.
template <class S>
std::string path_of(std::string const& folder) {
  return folder + (sizeof(S) == 4 ? "/rows.float" : "/rows.double");
}
template <class S>
std::string path_of_nearest(std::string const& folder) {
  return path_of<S>(folder) + ".nearest";
}

inline std::string path_of_pairs(std::string const& folder) { return folder + "/rows.pairs"; }

template <class Row>
std::vector<Row> read_all(std::string const& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<Row> rows;
  for (Row r; file.read(reinterpret_cast<char*>(&r), sizeof r);) rows.push_back(r);
  if (rows.empty()) throw std::runtime_error(path + ": no rows");
  return rows;
}

template <class S>
std::vector<row<S>> read_rows(std::string const& folder) {
  return read_all<row<S>>(path_of<S>(folder));
}
template <class S>
std::vector<nearest_row<S>> read_nearest_rows(std::string const& folder) {
  return read_all<nearest_row<S>>(path_of_nearest<S>(folder));
}

/// Says which row is the first that is wrong, and tests none after it; true if all are right.
template <class Row, class Right>
bool all_right(std::vector<Row> const& rows, Right const& right) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (right(rows[i])) continue;
    std::printf("row %zu of %zu is wrong\n", i + 1, rows.size());
    return false;
  }
  return true;
}

}  // namespace tests
