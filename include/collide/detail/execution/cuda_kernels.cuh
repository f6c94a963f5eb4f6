/// \file
/// The kernels that run bodies and function objects on an NVIDIA GPU. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error "collide/detail/execution/cuda_kernels.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <collide/detail/execution/cuda_block.cuh>

namespace collide::detail {

/// How many blocks of a body a processor should hold at a time, which limits the registers of a thread: its member
/// `residency<Block>`, or 1.
template <class Body, class Block, class = void>
inline constexpr int residency = 1;
template <class Body, class Block>
inline constexpr int residency<Body, Block, std::enable_if_t<(Body::template residency<Block> > 0)>> =
    Body::template residency<Block>;

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

/// Runs a body in one thread per block.
template <class Block, class Body>
__global__ void __launch_bounds__(threads_per_block, (residency<Body, Block>))
    run_threads(std::size_t blocks, Body body) {
  pdl_launch_dependents();
  pdl_wait();
  std::size_t const i = std::size_t{blockIdx.x} * threads_per_block + threadIdx.x;
  if (i >= blocks) return;
  typename Body::template scratch<Block> scratch;
  Block here(i);
  body(here, scratch);
}

/// Runs a body in one CUDA block per block.
template <class Block, class Body>
__global__ void __launch_bounds__(threads_per_block, (residency<Body, Block>)) run_blocks(Body body) {
  pdl_launch_dependents();
  pdl_wait();
  __shared__ typename Body::template scratch<Block> scratch;
  Block here(blockIdx.x);
  body(here, scratch);
}

template <class F>
__global__ void __launch_bounds__(threads_per_block) run_for_each(std::size_t n, F f) {
  pdl_wait();  // first: blocks of the next kernel would take the room of those that it waits for
  pdl_launch_dependents();
  std::size_t const i = std::size_t{blockIdx.x} * threads_per_block + threadIdx.x;
  if (i < n) f(i);
}

/// Kernel body of `for_each` over bytes.
struct fill_bytes {
  unsigned char* to;
  unsigned char byte;
  __device__ void operator()(std::size_t i) const { to[i] = byte; }
};

}  // namespace collide::detail
