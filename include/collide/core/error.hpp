/// \file
/// The exception that everything the library throws derives from.
#pragma once

#include <stdexcept>

namespace collide {

/// Base of every exception of the library. CUDA errors are the derived `cuda_error` (cuda.cuh). `what()` begins with
/// "collide: " and says in a sentence what is wrong. What a memory resource throws, such as std::bad_alloc, is passed
/// on as it is.
class error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace collide
