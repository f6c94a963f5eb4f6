/// \file
/// Time and floor of an execution space.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <vector>

#include <Eigen/Core>

#include <collide/detector.hpp>

namespace bench {

/// The median of at least one number; of an even number of them the upper one.
inline double median(std::vector<double> of) {
  auto const middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
  std::nth_element(of.begin(), middle, of.end());
  return *middle;
}

/// Time of complete work on the host, in seconds.
class host_stopwatch {
 public:
  template <class Space>
  explicit host_stopwatch(Space const&) {}

  template <class F>
  double operator()(F const& f) {
    auto const begin = std::chrono::steady_clock::now();
    f();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
};

/// The processor time of all threads, in seconds: for a machine with other work.
class processor_stopwatch {
 public:
  template <class F>
  double operator()(F const& f) {
    std::clock_t const begin = std::clock();
    f();
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  }
};

#if defined(__CUDACC__)
/// Time between two events on the space's stream, in seconds.
class cuda_stopwatch {
 public:
  template <class Space>
  explicit cuda_stopwatch(Space const& space) : stream_{space.stream()} {
    collide::cuda_check(cudaEventCreate(&begin_), "cudaEventCreate");
    collide::cuda_check(cudaEventCreate(&end_), "cudaEventCreate");
  }
  cuda_stopwatch(cuda_stopwatch const&) = delete;
  cuda_stopwatch& operator=(cuda_stopwatch const&) = delete;
  ~cuda_stopwatch() {
    cudaEventDestroy(begin_);
    cudaEventDestroy(end_);
  }

  template <class F>
  double operator()(F const& f) {
    collide::cuda_check(cudaEventRecord(begin_, stream_), "cudaEventRecord");
    f();
    collide::cuda_check(cudaEventRecord(end_, stream_), "cudaEventRecord");
    collide::cuda_check(cudaEventSynchronize(end_), "cudaEventSynchronize");
    float ms = 0;
    collide::cuda_check(cudaEventElapsedTime(&ms, begin_, end_), "cudaEventElapsedTime");
    return ms * 1e-3;
  }

 private:
  cudaStream_t stream_;
  cudaEvent_t begin_, end_;
};
#endif

template <class Space>
struct stopwatch_of {
#if defined(__CUDACC__)
  using type = std::conditional_t<Space::host_accessible, host_stopwatch, cuda_stopwatch>;
#else
  using type = host_stopwatch;
#endif
};
template <class Space>
using stopwatch = typename stopwatch_of<Space>::type;

/// Kernel functor of `for_each` over groups of four scalars, for CUDA: reads them all, and writes where they sum to a
/// value that they never sum to.
template <class S>
struct read_all {
  struct alignas(4 * sizeof(S)) four {
    S x, y, z, w;
  };
  four const* from;
  S* to;
  COLLIDE_HD void operator()(std::size_t i) const {
    four const v = from[i];
    if (v.x + v.y + v.z + v.w == S(0x1p99)) *to = v.x;
  }
};

/// Median seconds of reading every one of `n` packed centres once: what no query can go below. On the host with one
/// thread.
template <class Space, class S>
double floor_of(Space const& space, S const* xyz, std::size_t n) {
  collide::buffer<S> sink;
  S* const to = sink.reserve(space.resource(), 1);
  read_all<S> const body{reinterpret_cast<typename read_all<S>::four const*>(xyz), to};
  auto const read = [&] {
    if constexpr (Space::host_accessible) {
      *to = Eigen::Map<Eigen::Array<S, Eigen::Dynamic, 1> const>(xyz, static_cast<Eigen::Index>(3 * n)).sum();
    } else {
      space.for_each(3 * n / 4, body);
    }
  };
  stopwatch<Space> watch(space);
  std::vector<double> seconds;
  for (int i = 0; i < 50; ++i) seconds.push_back(watch(read));
  return median(seconds);
}

}  // namespace bench
