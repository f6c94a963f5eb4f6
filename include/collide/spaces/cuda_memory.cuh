/// \file
/// Memory resources for NVIDIA GPUs, and the error that failed CUDA calls throw. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error "collide/spaces/cuda_memory.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <string>

#include <cuda_runtime.h>

#include <collide/core/error.hpp>
#include <collide/core/memory.hpp>

namespace collide {

/// A CUDA call that failed. `what()` names the call, the file and the line; `code()` is CUDA's error. An error that a
/// kernel left behind is reported by a later call.
class cuda_error : public error {
 public:
  /// The error `code` of the call whose text is `call`, in line `line` of `file`.
  cuda_error(cudaError_t code, char const* call, char const* file, int line)
      : error(std::string("collide: ") + call + " failed: " + cudaGetErrorName(code) + " (" + cudaGetErrorString(code) +
              ") at " + file + ":" + std::to_string(line)),
        code_{code} {}

  /// CUDA's error.
  cudaError_t code() const { return code_; }

 private:
  cudaError_t code_;
};

/// Throws `cuda_error` unless `code` is cudaSuccess. `call` is the text of the call; `file` and `line` are those of the
/// caller.
inline void cuda_check(cudaError_t code, char const* call, char const* file = __builtin_FILE(),
                       int line = __builtin_LINE()) {
  if (code == cudaSuccess) return;
  cudaGetLastError();  // a failed call must not be reported again by the next one
  throw cuda_error(code, call, file, line);
}

/// Number of CUDA devices that can be used; 0 also where there is no driver.
inline int cuda_device_count() {
  int n = 0;
  if (cudaGetDeviceCount(&n) != cudaSuccess) {
    cudaGetLastError();
    return 0;
  }
  return n;
}

/// Device memory by cudaMalloc and cudaFree, which wait for the device: the default of the CUDA spaces, which allocate
/// only when something grows.
class cuda_memory final : public std::pmr::memory_resource {
 public:
  /// The one instance.
  static cuda_memory* get() {
    static cuda_memory instance;
    return &instance;
  }

 private:
  void* do_allocate(std::size_t n, std::size_t) override {
    void* p = nullptr;
    cuda_check(cudaMalloc(&p, n), "cudaMalloc");
    return p;
  }
  void do_deallocate(void* p, std::size_t, std::size_t) override {
    if (cudaFree(p) != cudaSuccess) cudaGetLastError();
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }
};

/// Device memory by cudaMallocAsync and cudaFreeAsync, in the order of a stream; never waits. For spaces of that
/// stream: work on another one must wait before it uses the memory. Allocation throws `cuda_error` if there is not
/// enough.
class cuda_async_memory final : public std::pmr::memory_resource {
 public:
  /// Memory in the order of `stream`, which must outlive this object and all that has memory of it.
  explicit cuda_async_memory(cudaStream_t stream) : stream_{stream} {}

 private:
  void* do_allocate(std::size_t n, std::size_t) override {
    void* p = nullptr;
    cuda_check(cudaMallocAsync(&p, n, stream_), "cudaMallocAsync");
    return p;
  }
  void do_deallocate(void* p, std::size_t, std::size_t) override {
    if (cudaFreeAsync(p, stream_) != cudaSuccess) cudaGetLastError();
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }

  cudaStream_t stream_;
};

/// Pinned host memory by cudaMallocHost and cudaFreeHost: copies of `streamed` from it run at full bandwidth and do
/// not block the host. Slow to allocate, and not available to other programs. Allocation throws `cuda_error` if there
/// is not enough.
class cuda_pinned_memory final : public std::pmr::memory_resource {
 public:
  /// The one instance.
  static cuda_pinned_memory* get() {
    static cuda_pinned_memory instance;
    return &instance;
  }

 private:
  void* do_allocate(std::size_t n, std::size_t) override {
    void* p = nullptr;
    cuda_check(cudaMallocHost(&p, n), "cudaMallocHost");
    return p;
  }
  void do_deallocate(void* p, std::size_t, std::size_t) override {
    if (cudaFreeHost(p) != cudaSuccess) cudaGetLastError();
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }
};

namespace detail {

/// Tells the host which memory it cannot read, in all of a program of which nvcc has compiled some part.
inline bool const host_is_told = [] {
  in_device_memory = [](void const* p) {
    cudaPointerAttributes memory{};
    if (cudaPointerGetAttributes(&memory, p) == cudaSuccess) return memory.type == cudaMemoryTypeDevice;
    cudaGetLastError();  // there is no device, and so no memory of one
    return false;
  };
  return true;
}();

}  // namespace detail

}  // namespace collide
