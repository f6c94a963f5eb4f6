/// \file
/// The execution spaces of a program: how to make one, what it runs on, whether it is there.
#pragma once

#include <collide/host.hpp>
#if defined(__CUDACC__)
#include <collide/cuda.cuh>
#endif

#include <fstream>
#include <memory_resource>
#include <string>

#include "choose.hpp"
#include "error.hpp"
#include "number.hpp"

namespace io {

/// The name of this computer's processor.
inline std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) == 0) return std::string(trimmed(line).substr(line.find(':') + 2));
  }
  return "CPU";
}

/// `Space`, as programs use it. The CUDA spaces are all alike.
template <class Space>
struct device_of {
#if defined(__CUDACC__)
  static void require() {
    if (collide::cuda_device_count() == 0) throw std::runtime_error("--space: this computer has no usable CUDA device");
  }
  /// Makes a device that of this thread: ranks take them in turn.
  static void take(int rank) {
    collide::cuda_check(cudaSetDevice(rank % collide::cuda_device_count()), "cudaSetDevice");
  }
  static std::pmr::memory_resource* memory() { return collide::cuda_memory::get(); }
  static Space make(int, std::pmr::memory_resource* memory) { return Space(nullptr, memory); }
  static int threads(Space const&) { return 1; }
  static std::string name() {
    cudaDeviceProp about;
    collide::cuda_check(cudaGetDeviceProperties(&about, 0), "cudaGetDeviceProperties");
    return about.name;
  }
#endif
};

template <>
struct device_of<collide::host> {
  static void require() {}
  static void take(int) {}
  static std::pmr::memory_resource* memory() { return std::pmr::get_default_resource(); }
  static collide::host make(int threads, std::pmr::memory_resource* memory) { return collide::host(threads, memory); }
  static int threads(collide::host const& space) { return space.threads(); }
  static std::string name() { return processor_name(); }
};

/// Calls f with the space of that name, as `choose` does. Throws if this program was built without it.
template <class F>
void choose_space(std::string const& name, F const& f) {
#if defined(__CUDACC__)
  choose(name, f, named<collide::host>{"host"}, named<collide::cuda>{"cuda"},
         named<collide::cuda_shared>{"cuda_shared"});
#else
  if (name != "host") throw std::runtime_error("--space " + name + ": this program was built without CUDA");
  choose(name, f, named<collide::host>{"host"});
#endif
}

}  // namespace io
