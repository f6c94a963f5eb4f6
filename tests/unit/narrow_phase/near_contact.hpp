/// Single triangles and spheres where a verdict is hard, with the exact one.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "../oracle/exact.hpp"

namespace tests {

/// All numbers are of the scalar type that the case was made for.
struct near_case {
  oracle::triangle shape;
  oracle::sphere ball;
  bool hit;
};

/// The same with a ball that moves.
struct near_sweep : near_case {
  oracle::point move;
};

/// The numbers in hexadecimal, for messages.
std::string describe(near_case const& c);
std::string describe(near_sweep const& c);

/// Nine cases for each of `n` triangles and centres: the radius is the exact distance, rounded, and -4, -3 .. 4 units
/// in the last place, and each of the nine is turned and mirrored in another way. Faces, edges and vertices are
/// touched, of triangles in general position, of slivers down to 1e-7 and of degenerate triangles; the distance is 1e-6
/// to 1e6 times the triangle's size, the offset from the origin up to 1e6 times; scales are 2^-140 to 2^120, and with
/// double all of its range.
template <class S>
std::vector<near_case> near_contact(unsigned seed, std::size_t n);

/// Three cases for each of `n` triangles and centres: the distance is a number of `S`, as all coordinates are
/// (Pythagorean quadruples, moved and scaled by powers of two), and the radius is the number before it, itself and the
/// next.
template <class S>
std::vector<near_case> ties(unsigned seed, std::size_t n);

/// Three cases for each of `n` triangles and centres whose coordinates are of a few exponents out of all that `S` has,
/// equal and next to equal coordinates among them: the exact distance, rounded, and one unit in the last place to
/// either side.
template <class S>
std::vector<near_case> mixed_exponents(unsigned seed, std::size_t n);

/// As `near_contact`, with balls that come closest at the beginning, at the end or in the middle of their way, which is
/// 1e-3 to 1e3 times as long as the triangle is large.
template <class S>
std::vector<near_sweep> near_sweeps(unsigned seed, std::size_t n);

/// Small integers, radii that are halves of them, and ways of any direction, null among them: every tie and degeneracy
/// occurs. `n` cases.
template <class S>
std::vector<near_sweep> lattice_sweeps(unsigned seed, std::size_t n);

/// As `mixed_exponents`, with ways of such coordinates too.
template <class S>
std::vector<near_sweep> mixed_sweeps(unsigned seed, std::size_t n);

}  // namespace tests
