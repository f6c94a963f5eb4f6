/// The cases of the mutation check, as make_rows writes them: bits, so that no flag of a compiler changes them.
#pragma once

#include <array>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <collide/geometry.hpp>

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

/// The file of the rows of `S`.
template <class S>
std::string path_of(std::string const& folder) {
  return folder + (sizeof(S) == 4 ? "/rows.float" : "/rows.double");
}

template <class S>
std::vector<row<S>> read_rows(std::string const& folder) {
  std::ifstream file(path_of<S>(folder), std::ios::binary);
  std::vector<row<S>> rows;
  for (row<S> r; file.read(reinterpret_cast<char*>(&r), sizeof r);) rows.push_back(r);
  if (rows.empty()) throw std::runtime_error(path_of<S>(folder) + ": no rows");
  return rows;
}

}  // namespace tests
