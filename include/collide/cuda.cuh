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

/// Execution space: an NVIDIA GPU, each thread on its own. Views point to device memory; work is put on a stream, and
/// calls do not wait for it unless they say so. Simpler than `cuda_shared`, which in most scenes is the faster one; the
/// results are the same. A small value that is copied into detectors. For the device that is current when it is made.
class cuda : public detail::cuda_space {
 public:
  using cuda_space::cuda_space;
  /// The name of the space, for messages.
  static constexpr char const* name() { return "cuda"; }

  template <class Kernel>
  using block = detail::serial_block<Kernel::items, 0>;

  /// Puts a kernel on the stream that runs `kernel` once for each of `blocks` blocks. Throws `cuda_error`.
  template <class Kernel>
  void launch(std::size_t blocks, Kernel const& kernel) const {
    if (blocks == 0) return;
    launch_kernel("launch of run_threads", detail::run_threads<block<Kernel>, Kernel>, grid_of(blocks), blocks, kernel);
  }

  /// How many blocks keep the device busy.
  std::size_t saturating_blocks() const { return static_cast<std::size_t>(sm_count_) * 2048; }

  /// How many blocks of a kernel can be at work at a time; here that does not matter.
  template <class Kernel>
  std::size_t max_resident_blocks() const {
    return std::numeric_limits<std::size_t>::max();
  }
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
    if (blocks == 0) return;
    if (blocks > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw error("collide: too much work for one CUDA launch");
    }
    launch_kernel("launch of run_blocks", detail::run_blocks<block<Kernel>, Kernel>, static_cast<unsigned>(blocks),
                  kernel);
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
