/// How often the program allocates.
#pragma once

#include <cstddef>

namespace tests {

/// How many calls of operator new there have been in this program so far, from all threads. A program that asks has
/// operators new and delete of counted_new.cpp.
std::size_t counted_news();

}  // namespace tests
