/// \file
/// Stand-ins for the CUDA spaces where no nvcc compiles: they end with a sentence.
#pragma once

#if !defined(__CUDACC__)

namespace collide {

namespace detail {

/// Cannot be made.
struct cuda_without_nvcc {
  template <class... Argument>
  explicit cuda_without_nvcc(Argument&&...) {
    static_assert(sizeof...(Argument) > 1000,
                  "collide: the spaces cuda and cuda_shared need nvcc: compile this source as CUDA, as name.cu or with "
                  "nvcc -x cu; with CMake, as LANGUAGE CUDA");
  }
};

}  // namespace detail

using cuda = detail::cuda_without_nvcc;
using cuda_shared = detail::cuda_without_nvcc;

}  // namespace collide

#endif
