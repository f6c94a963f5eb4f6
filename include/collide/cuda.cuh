/// \file
/// The execution spaces of an NVIDIA GPU: `cuda`, a thread per work item, and `cuda_shared`, blocks of threads that
/// work together through shared memory. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error "collide/cuda.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <cuda_runtime.h>

#include <collide/spaces/cuda_memory.cuh>
#include <collide/spaces/detail/block.hpp>
#include <collide/spaces/detail/cuda_block.cuh>
#include <collide/spaces/detail/tuning.hpp>

namespace collide {

namespace detail {

/// How many blocks of a kernel a processor should hold at a time, which limits the registers of a thread: its member
/// `min_blocks_per_sm<Block>`, or 1. For a functor of `for_each` the block is void.
template <class Kernel, class Block, class = void>
inline constexpr int min_blocks_per_sm = 1;
template <class Kernel, class Block>
inline constexpr int
    min_blocks_per_sm<Kernel, Block, std::enable_if_t<(Kernel::template min_blocks_per_sm<Block> > 0)>> =
        Kernel::template min_blocks_per_sm<Block>;

/// A kernel begins with these two. It lets the next kernel of the stream start, which then waits for its turn: so a
/// launch takes its time while the kernel before is at work. Where it was compiled for compute capability 9.0 or more,
/// and with `cuda_space::launch_kernel`.
__device__ __forceinline__ void pdl_launch_dependents() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaTriggerProgrammaticLaunchCompletion();
#endif
}
__device__ __forceinline__ void pdl_wait() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaGridDependencySynchronize();
#endif
}

/// True for a kernel whose few blocks have much to do: the threads of each work together even where those of others are
/// on their own. That is its member `is_cooperative`.
template <class Kernel, class = void>
inline constexpr bool is_cooperative = false;
template <class Kernel>
inline constexpr bool is_cooperative<Kernel, std::enable_if_t<Kernel::is_cooperative>> = true;

/// Runs a kernel in one thread per block.
template <class Block, class Kernel>
__global__ void __launch_bounds__(threads_per_block, (min_blocks_per_sm<Kernel, Block>))
    run_threads(std::size_t blocks, Kernel kernel) {
  pdl_launch_dependents();
  pdl_wait();
  std::size_t const i = std::size_t{blockIdx.x} * threads_per_block + threadIdx.x;
  if (i >= blocks) return;
  typename Kernel::template scratch<Block> scratch;
  Block here(i);
  kernel(here, scratch);
}

/// Runs a kernel in one CUDA block per block.
template <class Block, class Kernel>
__global__ void __launch_bounds__(threads_per_block, (min_blocks_per_sm<Kernel, Block>)) run_blocks(Kernel kernel) {
  pdl_launch_dependents();
  pdl_wait();
  __shared__ typename Kernel::template scratch<Block> scratch;
  Block here(blockIdx.x);
  kernel(here, scratch);
}

/// Threads of a block of `for_each`, of which none wait for each other: few, so that little work is on all processors,
/// and threads with many registers fill them; many where all processors are full and threads do little, as a device
/// starts a block a nanosecond.
inline constexpr int few_threads_of_for_each = 64, many_threads_of_for_each = 256;
template <class F>
inline constexpr int max_threads_of_for_each =
    min_blocks_per_sm<F, void> > 1 ? few_threads_of_for_each : many_threads_of_for_each;

template <class F>
__global__ void __launch_bounds__(max_threads_of_for_each<F>, (min_blocks_per_sm<F, void>))
    run_for_each(std::size_t n, F f) {
  pdl_wait();  // first: blocks of the next kernel would take the room of those that it waits for
  pdl_launch_dependents();
  std::size_t const i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < n) f(i);
}

/// Kernel functor of `for_each` over bytes.
struct fill_bytes {
  unsigned char* to;
  unsigned char byte;
  __device__ void operator()(std::size_t i) const { to[i] = byte; }
};

/// The base of both CUDA spaces: a stream and memory.
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
  /// The resource of device memory.
  std::pmr::memory_resource* resource() const { return resource_; }

  /// Waits until all work on the stream is done.
  void synchronize() const { cuda_check(cudaStreamSynchronize(stream_), "cudaStreamSynchronize"); }

  /// True if all work on the stream is done.
  bool is_done() const {
    cudaError_t const status = cudaStreamQuery(stream_);
    if (status != cudaErrorNotReady) cuda_check(status, "cudaStreamQuery");
    return status == cudaSuccess;
  }

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
    constexpr std::size_t threads_at_a_time = 2048;  // of a processor
    int const threads = n > threads_at_a_time * static_cast<std::size_t>(sm_count_) ? max_threads_of_for_each<F>
                                                                                    : few_threads_of_for_each;
    launch_kernel("launch of run_for_each", run_for_each<F>, grid_of(n, threads), threads, n, f);
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

  /// A mark behind the work that is on the stream, for `after`.
  std::shared_ptr<void> mark() const {
    cudaEvent_t made = nullptr;
    cuda_check(cudaEventCreateWithFlags(&made, cudaEventDisableTiming), "cudaEventCreateWithFlags");
    std::shared_ptr<void> event(made, [](cudaEvent_t e) { cudaEventDestroy(e); });
    cuda_check(cudaEventRecord(made, stream_), "cudaEventRecord");
    return event;
  }
  /// Has work that is put on the stream later begin after that before a mark, of any space of the process.
  void after(std::shared_ptr<void> const& mark) const {
    if (mark) cuda_check(cudaStreamWaitEvent(stream_, static_cast<cudaEvent_t>(mark.get()), 0), "cudaStreamWaitEvent");
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
  void launch_kernel(char const* call, void (*kernel)(Parameters...), unsigned blocks, int threads,
                     Parameters const&... arguments) const {
    cudaLaunchAttribute early{};
    early.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    early.val.programmaticStreamSerializationAllowed = 1;
    cudaLaunchConfig_t config{};
    config.gridDim = dim3(blocks);
    config.blockDim = dim3(static_cast<unsigned>(threads));
    config.stream = stream_;
    config.attrs = &early;
    config.numAttrs = has_pdl_ ? 1 : 0;
    cuda_check(cudaLaunchKernelEx(&config, kernel, arguments...), call);
  }

  /// Launches a kernel functor whose blocks are CUDA blocks.
  template <class Block, class Kernel>
  void launch_blocks(std::size_t blocks, Kernel const& kernel) const {
    if (blocks > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw error("collide: too much work for one CUDA launch");
    }
    launch_kernel("launch of run_blocks", run_blocks<Block, Kernel>, static_cast<unsigned>(blocks), threads_per_block,
                  kernel);
  }

  static unsigned grid_of(std::size_t n, int threads) {
    std::size_t const each = static_cast<std::size_t>(threads), blocks = (n + each - 1) / each;
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

}  // namespace detail

/// Execution space: an NVIDIA GPU, each thread on its own. Views point to device memory; work is put on a stream, and
/// calls do not wait for it unless they say so. Simpler than `cuda_shared`, which in most scenes is the faster one; the
/// results are the same. A small value that is copied into detectors. For the device that is current when it is made.
class cuda : public detail::cuda_space {
 public:
  using cuda_space::cuda_space;
  /// The name of the space, for messages.
  static constexpr char const* name() { return "cuda"; }

  template <class Kernel>
  using block = std::conditional_t<detail::is_cooperative<Kernel>, detail::cuda_block<Kernel::items>,
                                   detail::serial_block<Kernel::items, 0>>;

  /// Puts a kernel on the stream that runs `kernel` once for each of `blocks` blocks. Throws `cuda_error`, and `error`
  /// if threads work together in 2^31 blocks or more.
  template <class Kernel>
  void launch(std::size_t blocks, Kernel const& kernel) const {
    if (blocks == 0) return;
    if constexpr (detail::is_cooperative<Kernel>) return launch_blocks<block<Kernel>>(blocks, kernel);
    launch_kernel("launch of run_threads", detail::run_threads<block<Kernel>, Kernel>,
                  grid_of(blocks, detail::threads_per_block), detail::threads_per_block, blocks, kernel);
  }

  /// How many blocks keep the device busy.
  std::size_t saturating_blocks() const { return static_cast<std::size_t>(sm_count_) * 2048; }

  /// No limit: kernels of this space need not know how many of their blocks are at work at a time.
  template <class Kernel>
  std::size_t max_resident_blocks() const {
    return std::numeric_limits<std::size_t>::max();
  }
};

/// A thread that is alone with the candidates of its spheres is waited for.
template <>
struct bucket_tuning<cuda> : device_bucket_tuning {
  /// In nanoseconds; only the ratios count.
  static constexpr bucket_costs costs{0.12f, 0.004f, 0.06f, 0.04f, 7, 0, 0, 524288};
};

/// By what `automatic` chooses in `cuda`: measured on an H100.
template <>
struct broad_phase_costs<cuda> {
  /// In nanoseconds; only the ratios count.
  static constexpr broad_phase_cost_model value{0, 30, 0.08, 0.2, 30000};
};

/// Execution space: an NVIDIA GPU, the threads of a block working together through shared memory. Views point to device
/// memory; work is put on a stream, and calls do not wait for it unless they say so. The space to begin with on a GPU.
/// A small value that is copied into detectors. For the device that is current when it is made.
class cuda_shared : public detail::cuda_space {
 public:
  using cuda_space::cuda_space;
  /// The name of the space, for messages.
  static constexpr char const* name() { return "cuda_shared"; }

  template <class Kernel>
  using block = detail::cuda_block<Kernel::items>;

  /// Puts a kernel on the stream that runs `kernel` once for each of `blocks` blocks. Throws `cuda_error`, and `error`
  /// if there are 2^31 blocks or more.
  template <class Kernel>
  void launch(std::size_t blocks, Kernel const& kernel) const {
    if (blocks != 0) launch_blocks<block<Kernel>>(blocks, kernel);
  }

  /// How many blocks keep the device busy.
  std::size_t saturating_blocks() const { return static_cast<std::size_t>(sm_count_) * 8; }

  /// How many blocks of a kernel are at work at a time.
  template <class Kernel>
  std::size_t max_resident_blocks() const {
    return static_cast<std::size_t>(sm_count_) * detail::min_blocks_per_sm<Kernel, block<Kernel>>;
  }
};

}  // namespace collide
