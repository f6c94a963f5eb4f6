/// \file
/// The exception that everything the library throws derives from.
#pragma once

#include <stdexcept>

namespace collide {

/// Base of every exception of the library. CUDA errors are the derived `cuda_error` (cuda.cuh).
class error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace collide
