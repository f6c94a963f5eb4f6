/// Cases as mutate.py writes them.
#pragma once

#include <array>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <collide/geometry.hpp>

namespace tests {

/// 1 if the two touch, else 0; then the corners, the centre and the radius: bits, so that no flag changes them.
template <class S>
struct row {
  std::array<S, 14> numbers;

  bool hit() const { return numbers[0] != 0; }
  collide::triangle<S> triangle() const { return {at(1), at(4), at(7)}; }
  collide::sphere<S> sphere() const { return {at(10), numbers[13]}; }

 private:
  collide::vec3<S> at(std::size_t i) const { return {numbers[i], numbers[i + 1], numbers[i + 2]}; }
};

/// Reads `path`, to which the type's name is added.
template <class S>
std::vector<row<S>> read_rows(std::string const& path) {
  std::ifstream file(path + (sizeof(S) == 4 ? ".float" : ".double"), std::ios::binary);
  std::vector<row<S>> rows;
  for (row<S> r; file.read(reinterpret_cast<char*>(&r), sizeof r);) rows.push_back(r);
  if (rows.empty()) throw std::runtime_error(path + ": no rows");
  return rows;
}

}  // namespace tests
