/// \file
/// A stream beside that of a space, for copies that travel while the space works.
#pragma once

#include <type_traits>
#if defined(__CUDACC__)
#include <memory>

#include <collide/cuda.cuh>
#endif

namespace collide::detail {

/// Only CUDA spaces have streams: others do all in their own order.
template <class Space, class = void>
class side_stream {
 public:
  void begin(Space const&) {}
  void end(Space const&) const {}
  Space const& of(Space const& space) const { return space; }
};

#if defined(__CUDACC__)

template <class Space>
class side_stream<Space, std::enable_if_t<std::is_base_of<cuda_space, Space>::value>> {
 public:
  /// Has what is put on the side stream from now on begin after the work that the space has.
  void begin(Space const& space) {
    if (!side_) make(space);
    side_->after(space.mark());
  }
  /// Has what the space gets from now on begin after the work of the side stream.
  void end(Space const& space) const {
    if (side_) space.after(side_->mark());
  }
  /// A space that puts its work on the side stream, or the space itself where there is none yet.
  cuda_space const& of(Space const& space) const {
    if (side_) return *side_;
    return space;
  }

 private:
  /// Kernels that copy, as NCCL's do, go before blocks of a large kernel that has begun.
  void make(Space const& space) {
    int least = 0, greatest = 0;
    cuda_check(cudaDeviceGetStreamPriorityRange(&least, &greatest), "cudaDeviceGetStreamPriorityRange");
    cudaStream_t made = nullptr;
    cuda_check(cudaStreamCreateWithPriority(&made, cudaStreamNonBlocking, greatest), "cudaStreamCreateWithPriority");
    stream_.reset(made);
    side_ = std::make_unique<cuda_space>(made, space.resource());
  }

  struct destroy {
    void operator()(cudaStream_t stream) const { cudaStreamDestroy(stream); }
  };
  std::unique_ptr<std::remove_pointer_t<cudaStream_t>, destroy> stream_;
  std::unique_ptr<cuda_space> side_;
};

#endif

}  // namespace collide::detail
