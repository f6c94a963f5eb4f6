/// \file
/// Shared by the benchmarks' programs: their results say where they come from.
#pragma once

#include <cstddef>
#include <string>

#include <benchmark/benchmark.h>

#include <collide/detector.hpp>

#include "io/device.hpp"
#include "io/number.hpp"

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

/// How many spheres, or the like, an argument asks for: from `least` to what ids can count. 0 if it is no such number.
inline std::size_t count_of(char const* argument, std::size_t least) {
  std::size_t n = 0;
  return io::parse_number<std::size_t>(argument, n) && n >= least && n < collide::id(-1) ? n : 0;
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
