/// \file
/// Works that are timed in turn, so that what disturbs the machine disturbs all of them alike.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "stopwatch.hpp"

namespace bench {

/// One of the works, and what has to be done before it that is not timed.
struct contestant {
  std::string name;
  std::function<void()> work;
  std::function<void()> begin = [] {};
};

/// The same, after each has run once, so that it has its memory.
inline std::vector<contestant> warmed(std::vector<contestant> contestants) {
  for (auto const& c : contestants) c.work();
  return contestants;
}

/// Times all of them in every iteration, each time, also of all repetitions, in another order. The counters NAME_ms are
/// the medians of each; the time of the benchmark is the sum.
template <class Watch>
void race_by(benchmark::State& state, Watch& watch, std::vector<contestant> const& contestants) {
  std::vector<std::vector<double>> times(contestants.size());
  static std::size_t first = 0;
  for (auto _ : state) {
    double sum = 0;
    for (std::size_t k = 0; k < times.size(); ++k) {
      std::size_t const i = (first + k) % times.size();
      contestants[i].begin();
      times[i].push_back(watch(contestants[i].work));
      sum += times[i].back();
    }
    ++first;
    state.SetIterationTime(sum);
  }
  for (std::size_t i = 0; i < times.size(); ++i) state.counters[contestants[i].name + "_ms"] = median(times[i]) * 1e3;
}

/// The same by the clock of a space.
template <class Space>
void race(benchmark::State& state, Space const& space, std::vector<contestant> const& contestants) {
  stopwatch<Space> watch(space);
  race_by(state, watch, contestants);
}

}  // namespace bench
