/// \file
/// Shared by the peers: a scene, a benchmark, and a check of what they find.
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/bucket.cuh>

#include "io/scenes.hpp"
#include "scene.hpp"

namespace peers {

/// The scene that was asked for, in float, and what `exact` finds in it, sorted.
struct scene : bench::scene<float> {
  static inline io::scene_kind const* kind = io::find_scene("study");
  static inline std::size_t part = 1;  ///< divides the number of spheres

  std::vector<collide::pair> truth;

  explicit scene(io::scene const& from) : bench::scene<float>(from) {
    collide::detector<collide::bucket> detector;
    truth = detector.detect(mesh(), view(), collide::pairs(collide::order::canonical)).to_host();
  }

  std::size_t triangles() const { return corners.size() / 3; }
  collide::sphere_view<float> view() const { return spheres(); }

  static scene const& get() {
    static scene const made(kind->make(kind->spheres / part, kind->triangles, 0));
    return made;
  }
};

/// The test of a sphere and a triangle for libraries that leave it to their user: float arithmetic as in textbooks.
inline bool touch(collide::triangle<float> const& t, collide::sphere<float> const& s) {
  return collide::karabassi<collide::baseline>::intersects(t, s);
}

using pair_list = std::vector<collide::pair>;

/// The pairs of a query, as a list; this is not measured.
inline pair_list list_of(pair_list found) { return found; }
inline pair_list list_of(collide::pairs const& found) { return found.to_host(); }

/// Calls find(first, last, list) for parts of 0 .. n from `threads` threads, each with a list of its own, and returns
/// all that is in the lists. Parts are dealt out in turn.
template <class Find>
pair_list in_parts(std::size_t n, int threads, Find const& find) {
  constexpr std::size_t part = 4096;
  std::vector<pair_list> lists(static_cast<std::size_t>(threads));
  auto const parts = static_cast<std::ptrdiff_t>((n + part - 1) / part);
#pragma omp parallel for schedule(static, 1) num_threads(threads)
  for (int thread = 0; thread < threads; ++thread) {
    for (std::ptrdiff_t p = thread; p < parts; p += threads) {
      auto const first = static_cast<std::size_t>(p) * part;
      find(first, std::min(n, first + part), lists[static_cast<std::size_t>(thread)]);
    }
  }
  for (int thread = 1; thread < threads; ++thread) {
    auto const& list = lists[static_cast<std::size_t>(thread)];
    lists[0].insert(lists[0].end(), list.begin(), list.end());
  }
  return std::move(lists[0]);
}

/// Registers the benchmark peers/NAME/THREADS, or peers/NAME/THREADS/SCENE if that is not the study's: from arrays in
/// memory to all pairs in memory.
///
/// A `Peer` is made from the scene and a number of threads, and has `query()`, of which `list_of` is a list. Counters:
/// build_ms; query_ms; processor_ms, of all threads, for a machine that is shared; pairs; missed and invented, pairs
/// that `exact` has and has not.
template <class Peer>
void add(std::string const& name, std::vector<int> const& threads) {
  std::string const of = scene::kind->name == "study" ? "" : "/" + std::string(scene::kind->name);
  for (int const t : threads) {
    benchmark::RegisterBenchmark(("peers/" + name + "/" + std::to_string(t) + of).c_str(),
                                 [t](benchmark::State& state) {
                                   using clock = std::chrono::steady_clock;
                                   auto const& from = scene::get();
                                   double build = 0, query = 0, processor = 0;
                                   pair_list found;
                                   for (auto _ : state) {
                                     std::clock_t const used = std::clock();
                                     auto const begin = clock::now();
                                     Peer peer(from, t);
                                     auto const built = clock::now();
                                     auto result = peer.query();
                                     auto const end = clock::now();
                                     processor += static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC;
                                     found = list_of(std::move(result));
                                     build += std::chrono::duration<double>(built - begin).count();
                                     query += std::chrono::duration<double>(end - built).count();
                                     state.SetIterationTime(std::chrono::duration<double>(end - begin).count());
                                   }
                                   std::sort(found.begin(), found.end());
                                   pair_list missed, invented;
                                   std::set_difference(from.truth.begin(), from.truth.end(), found.begin(), found.end(),
                                                       std::back_inserter(missed));
                                   std::set_difference(found.begin(), found.end(), from.truth.begin(), from.truth.end(),
                                                       std::back_inserter(invented));
                                   auto const runs = static_cast<double>(state.iterations());
                                   state.counters["build_ms"] = 1e3 * build / runs;
                                   state.counters["query_ms"] = 1e3 * query / runs;
                                   state.counters["processor_ms"] = 1e3 * processor / runs;
                                   state.counters["pairs"] = static_cast<double>(found.size());
                                   state.counters["missed"] = static_cast<double>(missed.size());
                                   state.counters["invented"] = static_cast<double>(invented.size());
                                 })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace peers
