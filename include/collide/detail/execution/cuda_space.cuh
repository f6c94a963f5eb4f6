/// \file
/// What both CUDA spaces have in common. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error "collide/detail/execution/cuda_space.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <cuda_runtime.h>

#include <collide/cuda_memory.cuh>
#include <collide/detail/execution/cuda_kernels.cuh>

namespace collide::detail {

/// What both CUDA spaces have in common: a stream and memory.
class cuda_space {
 public:
  /// A space for the device that is current now, which must be current in every later call.
  ///
  /// \param stream    where all work is put; null is CUDA's default stream
  /// \param resource  where device memory comes from; null is `cuda_memory`. Memory is used in the order of the stream.
  /// \throws cuda_error  if there is no usable device
  ///
  /// Stream and resource must outlive everything that was made with the space.
  explicit cuda_space(cudaStream_t stream = nullptr, std::pmr::memory_resource* resource = nullptr)
      : stream_{stream}, resource_{resource != nullptr ? resource : cuda_memory::get()} {
    int device = 0;
    cuda_check(cudaGetDevice(&device), "cudaGetDevice");
    cuda_check(cudaDeviceGetAttribute(&sm_count_, cudaDevAttrMultiProcessorCount, device), "cudaDeviceGetAttribute");
    cudaFuncAttributes compiled{};
    cuda_check(cudaFuncGetAttributes(&compiled, run_for_each<fill_bytes>), "cudaFuncGetAttributes");
    has_pdl_ = compiled.ptxVersion >= 90;
  }

  /// The stream that all work is put on.
  cudaStream_t stream() const { return stream_; }
  /// Where device memory comes from.
  std::pmr::memory_resource* resource() const { return resource_; }

  /// Waits until all work on the stream is done.
  void synchronize() const { cuda_check(cudaStreamSynchronize(stream_), "cudaStreamSynchronize"); }

  /// True if the host reads this memory without waiting for anything: not here.
  static constexpr bool host_accessible = false;

  /// False if the memory at `p` is known not to be this space's: pageable memory, where the device cannot read that.
  static bool reads(void const* p) {
    cudaPointerAttributes memory{};
    cuda_check(cudaPointerGetAttributes(&memory, p), "cudaPointerGetAttributes");
    if (memory.type != cudaMemoryTypeUnregistered) return true;
    int device = 0, reads_pageable = 0;
    cuda_check(cudaGetDevice(&device), "cudaGetDevice");
    cuda_check(cudaDeviceGetAttribute(&reads_pageable, cudaDevAttrPageableMemoryAccess, device),
               "cudaDeviceGetAttribute");
    return reads_pageable != 0;
  }

  /// Puts a kernel on the stream that calls f(i) for all i < n. Throws `cuda_error`.
  template <class F>
  void for_each(std::size_t n, F const& f) const {
    if (n == 0) return;
    launch_kernel("launch of run_for_each", run_for_each<F>, grid_of(n), n, f);
  }

  /// Puts work on the stream that sets `bytes` bytes. A little is filled by a kernel: in a graph, between kernels, that
  /// takes half as long as a memory set.
  void fill(void* to, unsigned char byte, std::size_t bytes) const {
    constexpr std::size_t little = 16384;
    if (bytes <= little) {
      for_each(bytes, fill_bytes{static_cast<unsigned char*>(to), byte});
    } else {
      cuda_check(cudaMemsetAsync(to, byte, bytes, stream_), "cudaMemsetAsync");
    }
  }

  /// The value at `from`. Waits.
  template <class T>
  T read(T const* from) const {
    T value;
    copy_to_host(&value, from, 1);
    return value;
  }

  /// Copies `n` values from the device and waits.
  template <class T>
  void copy_to_host(T* to, T const* from, std::size_t n) const {
    if (n == 0) return;
    cuda_check(cudaMemcpyAsync(static_cast<void*>(to), from, n * sizeof(T), cudaMemcpyDeviceToHost, stream_),
               "cudaMemcpyAsync");
    synchronize();
  }

  /// Copies `n` values to the device and waits; the source may be changed as soon as the call returns.
  template <class T>
  void copy_from_host(T* to, T const* from, std::size_t n) const {
    if (n == 0) return;
    cuda_check(cudaMemcpyAsync(static_cast<void*>(to), from, n * sizeof(T), cudaMemcpyHostToDevice, stream_),
               "cudaMemcpyAsync");
    synchronize();
  }

  /// Copies `bytes` bytes to this device from memory of any other of the process, or its own, in the order of the
  /// stream.
  void copy_from_any_device(void* to, void const* from, std::size_t bytes) const {
    if (bytes == 0) return;
    read_directly(from);
    cuda_check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDefault, stream_), "cudaMemcpyAsync");
  }

 protected:
  /// Has this device read the memory of that at `p` without help of the host, where it can.
  static void read_directly(void const* p) {
    cudaPointerAttributes memory{};
    cuda_check(cudaPointerGetAttributes(&memory, p), "cudaPointerGetAttributes");
    int device = 0, can = 0;
    cuda_check(cudaGetDevice(&device), "cudaGetDevice");
    if (memory.type != cudaMemoryTypeDevice || memory.device == device) return;
    thread_local std::vector<std::pair<int, int>> tried;  // to find out takes longer than a short copy
    std::pair<int, int> const both(device, memory.device);
    if (std::find(tried.begin(), tried.end(), both) != tried.end()) return;
    cuda_check(cudaDeviceCanAccessPeer(&can, device, memory.device), "cudaDeviceCanAccessPeer");
    if (can != 0 && cudaDeviceEnablePeerAccess(memory.device, 0) != cudaSuccess) {
      cudaGetLastError();  // it does already, or copies go by way of the host
    }
    tried.push_back(both);
  }

  /// Launches a kernel that begins with `pdl_wait`.
  template <class... Parameters>
  void launch_kernel(char const* call, void (*kernel)(Parameters...), unsigned blocks,
                     Parameters const&... arguments) const {
    cudaLaunchAttribute early{};
    early.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    early.val.programmaticStreamSerializationAllowed = 1;
    cudaLaunchConfig_t config{};
    config.gridDim = dim3(blocks);
    config.blockDim = dim3(threads_per_block);
    config.stream = stream_;
    config.attrs = &early;
    config.numAttrs = has_pdl_ ? 1 : 0;
    cuda_check(cudaLaunchKernelEx(&config, kernel, arguments...), call);
  }

  static unsigned grid_of(std::size_t n) {
    std::size_t const blocks = (n + threads_per_block - 1) / threads_per_block;
    if (blocks > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw error("collide: too much work for one CUDA launch");
    }
    return static_cast<unsigned>(blocks);
  }

  cudaStream_t stream_;
  std::pmr::memory_resource* resource_;
  int sm_count_ = 1;
  bool has_pdl_ = false;  ///< see `pdl_wait`
};

}  // namespace collide::detail
