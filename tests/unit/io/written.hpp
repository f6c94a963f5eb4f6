/// \file
/// Files for tests of what reads them.
#pragma once

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

namespace tests {

/// A file with this text that is gone after the test.
struct written {
  std::string path;
  written(std::string const& text, std::string const& ending)
      : path{"collide-test-mesh-" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + ending} {
    std::ofstream(path, std::ios::binary) << text;
  }
  ~written() { std::remove(path.c_str()); }
};

}  // namespace tests
