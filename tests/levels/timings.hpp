/// \file
/// The processor's time that a job takes, and a hash of its results, which is the same at each level of optimisation.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
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

/// Prints the name of a scene, the least time of `job()`, which is called for a tenth of a second and three times at
/// least, and the hash of `results()` after the first call.
template <class Job, class Results>
void timed(std::string const& name, Job const& job, Results const& results) {
  job();  // memory is allocated
  std::uint64_t const hash = hash_of(results());
  double least = 1e9, spent = 0;
  for (int k = 0; k < 3 || spent < 0.1; ++k) {
    double const before = seconds();
    job();
    double const now = seconds() - before;
    least = std::min(least, now);
    spent += now;
  }
  std::printf("%s %.6f %016llx\n", name.c_str(), least, static_cast<unsigned long long>(hash));
  std::fflush(stdout);
}
