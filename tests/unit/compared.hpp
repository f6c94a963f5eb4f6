/// Notes of what tests compare with formulas, for docs/verification.md: `bench/verification` collects them.
#pragma once

#include <cstdio>
#include <cstdlib>

#include <doctest/doctest.h>

namespace tests {

/// Appends a line to the file that the environment variable COLLIDE_COMPARED names, if it is set: the running test
/// case, the scalar type, what is compared, the formula, what the library gives, what the formula gives, and how many
/// cases that stands for, between tabs. It checks nothing: a CHECK beside it does.
template <class S>
void compared(char const* what, char const* formula, double ours, double expected, std::size_t cases = 1) {
  char const* const path = std::getenv("COLLIDE_COMPARED");
  if (path == nullptr) return;
  std::FILE* const file = std::fopen(path, "a");
  REQUIRE(file != nullptr);
  std::fprintf(file, "%s\t%s\t%s\t%s\t%.17g\t%.17g\t%zu\n", doctest::getContextOptions()->currentTest->m_name,
               sizeof(S) == 4 ? "float" : "double", what, formula, ours, expected, cases);
  std::fclose(file);
}

}  // namespace tests
