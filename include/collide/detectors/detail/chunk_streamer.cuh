/// \file
/// Streams spheres from host memory to a space, a chunk at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#if defined(__CUDACC__)
#include <array>
#include <memory>
#include <type_traits>

#include <collide/cuda.cuh>
#endif

namespace collide::detail {

/// The memory that a view of spheres reads, as few contiguous ranges: one if the centres are packed or the spheres are
/// quadruples, and one more for radii in an array of their own, three if the coordinates are. Arrays of one stride that
/// are interleaved form one range. It is copied with the gaps between its elements: the copy has the strides of the
/// original.
template <class Spheres>
class contiguous_ranges {
  using S = typename Spheres::scalar;

 public:
  explicit contiguous_ranges(Spheres const& spheres) : spheres_{spheres} {
    spheres_.for_each_array([this](S const* array, std::size_t stride) { add(array, stride); });
    for (std::size_t k = 0; k < count_; ++k) {
      ranges_[k].begin = size_;
      size_ += (length(ranges_[k]) + alignment - 1) / alignment * alignment;
    }
  }

  /// Number of elements of all copies, each range at a multiple of 64 elements.
  std::size_t size() const { return size_; }

  /// Calls copy(to, from, n) for each range; returns a view of the copies.
  template <class Copy>
  Spheres copy(S* to, Copy const& copy) const {
    for (std::size_t k = 0; k < count_; ++k) copy(to + ranges_[k].begin, ranges_[k].from, length(ranges_[k]));
    Spheres copied = spheres_;
    copied.for_each_array([&](S const*& array, std::size_t stride) {
      auto const has_it = [&](range const& p) {
        return p.stride == stride && !std::less<>{}(array, p.from) && std::less<>{}(array, p.from + p.width);
      };
      range const& p = *std::find_if(ranges_, ranges_ + count_, has_it);
      array = to + p.begin + (array - p.from);
    });
    return copied;
  }

 private:
  static constexpr std::size_t max_ranges = 7;  ///< three coordinates, a radius and a displacement
  static constexpr std::size_t alignment = 64;

  /// `width` elements from `from` on, and again after every `stride`.
  struct range {
    S const* from;
    std::size_t width, stride;
    std::size_t begin;  ///< of the copy
  };

  void add(S const* array, std::size_t stride) {
    for (std::size_t k = 0; k < count_; ++k) {
      range& p = ranges_[k];
      S const* const from = std::min(p.from, array, std::less<>{});
      S const* const end = std::max(p.from + p.width, array + 1, std::less<>{});
      auto const width = static_cast<std::size_t>(end - from);
      if (p.stride != stride || width > stride) continue;
      p.from = from;
      p.width = width;
      return;
    }
    ranges_[count_++] = {array, 1, stride, 0};
  }

  std::size_t length(range const& p) const {
    return spheres_.size() == 0 ? 0 : (spheres_.size() - 1) * p.stride + p.width;
  }

  Spheres spheres_;
  range ranges_[max_ranges] = {};
  std::size_t count_ = 0;
  std::size_t size_ = 0;
};

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
