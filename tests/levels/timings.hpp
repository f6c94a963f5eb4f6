/// \file
/// The time of the processor that a job takes, and a number that its results have, whatever they were compiled with.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

/// Seconds of the processor.
inline double seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// FNV-1a of the bytes of an array.
template <class T>
std::uint64_t hash_of(std::vector<T> const& of) {
  std::uint64_t hash = 14695981039346656037u;
  auto const* bytes = reinterpret_cast<unsigned char const*>(of.data());
  for (std::size_t i = 0; i < of.size() * sizeof(T); ++i) hash = (hash ^ bytes[i]) * 1099511628211u;
  return hash;
}

/// Prints the name of a scene, the least of three times of `job()`, and the hash of what `results()` returns then.
template <class Job, class Results>
void timed(std::string const& name, Job const& job, Results const& results) {
  job();  // memory is allocated
  double least = 1e9;
  for (int k = 0; k < 3; ++k) {
    double const before = seconds();
    job();
    least = std::min(least, seconds() - before);
  }
  std::printf("%s %.6f %016llx\n", name.c_str(), least, static_cast<unsigned long long>(hash_of(results())));
  std::fflush(stdout);
}
