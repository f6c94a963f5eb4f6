/// \file
/// What the benchmarks' programs have in common: their results say where they come from.
#pragma once

#include <string>

#include <benchmark/benchmark.h>

#include <collide/detector.hpp>

#include "io/device.hpp"

namespace bench {

/// True if there is a GPU to measure on, and the program was compiled for one.
inline bool has_gpu() {
#if defined(__CUDACC__)
  return collide::cuda_device_count() > 0;
#else
  return false;
#endif
}

/// The GPU that is measured on.
inline std::string device_name() {
#if defined(__CUDACC__)
  if (has_gpu()) return io::device_of<collide::cuda>::name();
#endif
  return "no GPU";
}

/// Runs what was registered. Returns what `main` is to return.
inline int run() {
  benchmark::AddCustomContext("commit", COLLIDE_COMMIT);
  benchmark::AddCustomContext("processor", io::processor_name());
  benchmark::AddCustomContext("threads", std::to_string(collide::host().threads()));
  benchmark::AddCustomContext("device", device_name());
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace bench
