/// \file
/// Streams spheres from host memory to a space, a chunk at a time.
#pragma once

#include <algorithm>
#include <cstddef>

#include <collide/detectors/detail/contiguous_ranges.hpp>
#if defined(__CUDACC__)
#include <array>
#include <memory>
#include <type_traits>

#include <collide/cuda.cuh>
#endif

namespace collide::detail {

/// each(space, spheres, size, f) calls f(chunk, first) for all spheres, `size` of them at a time, the first of them
/// being number `first`; `size` is from 1 to the number of spheres.
template <class Space, class Spheres, bool HostMemory = Space::host_accessible>
class chunk_streamer;

/// The streamer for spaces that read host memory: chunks are views of it, nothing is copied.
template <class Space, class Spheres>
class chunk_streamer<Space, Spheres, true> {
 public:
  template <class F>
  void for_each_chunk(Space const&, Spheres const& spheres, std::size_t size, F const& f) {
    for (std::size_t first = 0; first < spheres.size(); first += size) {
      f(spheres.subview(first, std::min(size, spheres.size() - first)), first);
    }
  }
};

#if defined(__CUDACC__)

struct cuda_destroy {
  void operator()(cudaStream_t s) const {
    if (cudaStreamDestroy(s) != cudaSuccess) cudaGetLastError();
  }
  void operator()(cudaEvent_t e) const {
    if (cudaEventDestroy(e) != cudaSuccess) cudaGetLastError();
  }
};

/// The streamer for the CUDA spaces: chunks are copied to the device on a stream of their own, while earlier ones are
/// queried. The streams wait for each other by events; the host waits for neither.
template <class Space, class Spheres>
class chunk_streamer<Space, Spheres, false> {
 public:
  chunk_streamer() {
    cudaStream_t stream = nullptr;  // not blocked by the default stream, which the space's may be
    cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
    copies_.reset(stream);
  }

  template <class F>
  void for_each_chunk(Space const& space, Spheres const& spheres, std::size_t size, F const& f) {
    std::size_t const n = (spheres.size() - 1) / size + 1;
    std::size_t const capacity = contiguous_ranges<Spheres>(spheres.subview(0, size)).size();
    for (std::size_t k = 0; k < std::min(n, staging_.size()); ++k) {
      staging_[k].memory.reserve(space.resource(), capacity);
      staging_[k].reusable.record(
          space.stream());  // an earlier query may still read it; memory may come in stream order
    }
    try {
      for (std::size_t k = 0, submitted = 0; k < n; ++k) {
        for (; submitted < std::min(n, k + staging_.size()); ++submitted) {
          std::size_t const first = submitted * size;
          copy_async(staging_[submitted % staging_.size()],
                     spheres.subview(first, std::min(size, spheres.size() - first)));
        }
        staging_buffer& here = staging_[k % staging_.size()];
        here.copied.wait(space.stream());
        f(here.spheres, k * size);
        here.reusable.record(space.stream());
      }
    } catch (...) {
      if (cudaStreamSynchronize(copies_.get()) != cudaSuccess) cudaGetLastError();
      throw;
    }
    // the caller's memory may go now
    cuda_check(cudaStreamSynchronize(copies_.get()), "cudaStreamSynchronize");
  }

 private:
  using S = typename Spheres::scalar;

  /// A CUDA event: a point of a stream that other streams wait for.
  class event {
   public:
    event() {
      cudaEvent_t e = nullptr;
      cuda_check(cudaEventCreateWithFlags(&e, cudaEventDisableTiming), "cudaEventCreateWithFlags");
      event_.reset(e);
    }
    void record(cudaStream_t s) const { cuda_check(cudaEventRecord(event_.get(), s), "cudaEventRecord"); }
    void wait(cudaStream_t s) const { cuda_check(cudaStreamWaitEvent(s, event_.get(), 0), "cudaStreamWaitEvent"); }

   private:
    std::unique_ptr<std::remove_pointer_t<cudaEvent_t>, cuda_destroy> event_;
  };

  /// A staging buffer: device memory for a chunk, and its events.
  struct staging_buffer {
    buffer<S> memory;
    Spheres spheres;
    event copied, reusable;
  };

  void copy_async(staging_buffer& to, Spheres const& chunk) {
    to.reusable.wait(copies_.get());
    to.spheres = contiguous_ranges<Spheres>(chunk).copy(to.memory.data(), [this](S* there, S const* from,
                                                                                 std::size_t n) {
      cuda_check(cudaMemcpyAsync(there, from, n * sizeof(S), cudaMemcpyHostToDevice, copies_.get()), "cudaMemcpyAsync");
    });
    to.copied.record(copies_.get());
  }

  /// Three staging buffers: with two, copying stops whenever the host is not done with a chunk before the copy of the
  /// next one ends; with three it may be late by as long as a copy takes.
  std::array<staging_buffer, 3> staging_;
  std::unique_ptr<std::remove_pointer_t<cudaStream_t>, cuda_destroy> copies_;
};

#endif

}  // namespace collide::detail
