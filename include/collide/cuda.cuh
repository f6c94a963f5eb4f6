/// \file
/// The execution spaces of an NVIDIA GPU: `cuda`, a thread per work item, and `cuda_shared`, blocks of threads that
/// work together through shared memory. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error "collide/cuda.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <limits>

#include <collide/cuda_memory.cuh>
#include <collide/detail/execution/block.hpp>
#include <collide/detail/execution/cuda_block.cuh>
#include <collide/detail/execution/cuda_kernels.cuh>
#include <collide/detail/execution/cuda_space.cuh>
#include <collide/detail/execution/tuning.hpp>

namespace collide {

/// Execution space: an NVIDIA GPU, each thread on its own. Views point to device memory; work is put on a stream.
class cuda : public detail::cuda_space {
 public:
  using cuda_space::cuda_space;
  static constexpr char const* name() { return "cuda"; }

  template <class Body>
  using block = detail::serial_block<Body::items, 0>;

  template <class Body>
  void launch(std::size_t blocks, Body const& body) const {
    if (blocks == 0) return;
    launch_kernel("launch of run_threads", detail::run_threads<block<Body>, Body>, grid_of(blocks), blocks, body);
  }

  std::size_t saturating_blocks() const { return static_cast<std::size_t>(sm_count_) * 2048; }

  template <class Body>
  std::size_t max_resident_blocks() const {
    return std::numeric_limits<std::size_t>::max();
  }
};

/// Measured on an H100.
template <>
struct broad_phase_costs<cuda> {
  static constexpr broad_phase_cost_model value{0, 30, 0.08, 0.2, 30000};
};

/// Execution space: an NVIDIA GPU, the threads of a block working together through shared memory. Views point to device
/// memory; work is put on a stream.
class cuda_shared : public detail::cuda_space {
 public:
  using cuda_space::cuda_space;
  static constexpr char const* name() { return "cuda_shared"; }

  template <class Body>
  using block = detail::cuda_block<Body::items>;

  template <class Body>
  void launch(std::size_t blocks, Body const& body) const {
    if (blocks == 0) return;
    if (blocks > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw error("collide: too much work for one CUDA launch");
    }
    launch_kernel("launch of run_blocks", detail::run_blocks<block<Body>, Body>, static_cast<unsigned>(blocks), body);
  }

  std::size_t saturating_blocks() const { return static_cast<std::size_t>(sm_count_) * 8; }

  /// How many blocks of a body are at work at a time.
  template <class Body>
  std::size_t max_resident_blocks() const {
    return static_cast<std::size_t>(sm_count_) * detail::residency<Body, block<Body>>;
  }
};

}  // namespace collide
