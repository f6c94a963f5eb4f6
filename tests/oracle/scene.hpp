/// Exact answers for whole scenes, and the hard cases from their files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "exact.hpp"

namespace oracle {

struct id_pair {
  std::uint32_t sphere, triangle;

  friend bool operator==(id_pair p, id_pair q) { return p.sphere == q.sphere && p.triangle == q.triangle; }
  friend bool operator<(id_pair p, id_pair q) {
    return p.sphere != q.sphere ? p.sphere < q.sphere : p.triangle < q.triangle;
  }
};

/// The pairs that an answer may have, by sphere, then triangle. An exact one is `exact`; another has every pair of
/// `certain`, and no pair that `possible` lacks.
struct expectation {
  std::vector<id_pair> exact;
  std::vector<id_pair> certain;   ///< the pairs with radius * (1 - band)
  std::vector<id_pair> possible;  ///< the pairs with radius * (1 + band)
};

/// Compares every sphere with every triangle. With band 0 all three answers are the exact one.
expectation expect(std::vector<triangle> const& triangles, std::vector<sphere> const& spheres, double band = 0);

/// A row of the hard cases, see tests/data/README.md.
struct hard_case {
  int id, group;
  std::string family, sub;
  bool hit;
  triangle shape;
  sphere ball;
  point move;  ///< of swept cases
};

/// float_inputs: the numbers are floats. Throws std::runtime_error where the file is not what it should be.
std::vector<hard_case> read_hard_cases(std::string const& path, bool float_inputs);

}  // namespace oracle
