/// \file
/// The kernels that run kernels and function objects on an NVIDIA GPU. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error "collide/detail/execution/cuda_kernels.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <collide/detail/execution/cuda_block.cuh>

namespace collide::detail {

/// How many blocks of a kernel a processor should hold at a time, which limits the registers of a thread: its member
/// `min_blocks_per_sm<Block>`, or 1.
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

template <class F>
__global__ void __launch_bounds__(threads_per_block) run_for_each(std::size_t n, F f) {
  pdl_wait();  // first: blocks of the next kernel would take the room of those that it waits for
  pdl_launch_dependents();
  std::size_t const i = std::size_t{blockIdx.x} * threads_per_block + threadIdx.x;
  if (i < n) f(i);
}

/// Kernel functor of `for_each` over bytes.
struct fill_bytes {
  unsigned char* to;
  unsigned char byte;
  __device__ void operator()(std::size_t i) const { to[i] = byte; }
};

}  // namespace collide::detail
