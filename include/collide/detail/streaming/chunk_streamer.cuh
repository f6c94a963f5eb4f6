/// \file
/// Streams spheres from host memory to a space, a chunk at a time.
#pragma once

#include <algorithm>
#include <cstddef>

#include <collide/detail/streaming/contiguous_ranges.hpp>
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
class chunks;

/// The streamer for spaces that read host memory: chunks are views of it, nothing is copied.
template <class Space, class Spheres>
class chunks<Space, Spheres, true> {
 public:
  template <class F>
  void each(Space const&, Spheres const& spheres, std::size_t size, F const& f) {
    for (std::size_t first = 0; first < spheres.size(); first += size) {
      f(spheres.part(first, std::min(size, spheres.size() - first)), first);
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
class chunks<Space, Spheres, false> {
 public:
  chunks() {
    cudaStream_t stream = nullptr;  // not blocked by the default stream, which the space's may be
    cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
    copies_.reset(stream);
  }

  template <class F>
  void each(Space const& space, Spheres const& spheres, std::size_t size, F const& f) {
    std::size_t const n = (spheres.size() - 1) / size + 1;
    std::size_t const room = pieces<Spheres>(spheres.part(0, size)).size();
    for (std::size_t k = 0; k < std::min(n, places_.size()); ++k) {
      places_[k].memory.reserve(space.resource(), room);
      places_[k].free.record(space.stream());  // an earlier query may still read it; memory may come in stream order
    }
    try {
      for (std::size_t k = 0, sent = 0; k < n; ++k) {
        for (; sent < std::min(n, k + places_.size()); ++sent) {
          std::size_t const first = sent * size;
          send(places_[sent % places_.size()], spheres.part(first, std::min(size, spheres.size() - first)));
        }
        place& here = places_[k % places_.size()];
        here.full.wait(space.stream());
        f(here.spheres, k * size);
        here.free.record(space.stream());
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
  struct place {
    buffer<S> memory;
    Spheres spheres;
    event full, free;
  };

  void send(place& to, Spheres const& chunk) {
    to.free.wait(copies_.get());
    to.spheres = pieces<Spheres>(chunk).copy(to.memory.data(), [this](S* there, S const* from, std::size_t n) {
      cuda_check(cudaMemcpyAsync(there, from, n * sizeof(S), cudaMemcpyHostToDevice, copies_.get()), "cudaMemcpyAsync");
    });
    to.full.record(copies_.get());
  }

  /// Three staging buffers: with two, copying stops whenever the host is not done with a chunk before the copy of the
  /// next one ends; with three it may be late by as long as a copy takes.
  std::array<place, 3> places_;
  std::unique_ptr<std::remove_pointer_t<cudaStream_t>, cuda_destroy> copies_;
};

#endif

}  // namespace collide::detail
