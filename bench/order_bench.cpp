/// \file
/// The thirteen scenes with their triangles, vertices and spheres in other orders, on the host:
/// order_bench [PART [THREADS]] [OPTION OF GOOGLE BENCHMARK...]
///
/// Names are orders/SCENE/ORDER/RULE, with the scenes of io/scenes.hpp and the orders of `generate`: `renumbered` are
/// triangles and vertices shuffled. RULE is `mesh` for build(mesh), `radius` for build(mesh, radius): each with the
/// first query after it, into the sink `pairs`, of a detector that has its memory. Times are the processor's, of all
/// threads: others may be at work. Counters: pairs; least_ms and median_ms of build and query, build_ms, the least of
/// the build alone, and again_ms, the least of a query that comes again. PART divides the numbers of spheres and of
/// triangles, down to a thousand, to try things out; THREADS is 1 if not given.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/bucket.cuh>

#include "io/scenes.hpp"
#include "io/scenes/order.hpp"
#include "program.hpp"
#include "scene.hpp"
#include "stopwatch.hpp"

namespace {

/// An order of everything in a scene.
struct scene_order {
  char const* name;
  io::order triangles, vertices, spheres;
};
constexpr io::order made = io::order::made, shuffled = io::order::shuffled;
constexpr scene_order orders[] = {{"made", made, made, made},
                                  {"shuffled", shuffled, made, made},
                                  {"halves", io::order::halves, made, made},
                                  {"along_x", io::order::along_x, made, made},
                                  {"renumbered", shuffled, shuffled, made},
                                  {"spheres_shuffled", made, made, shuffled},
                                  {"spheres_along_x", made, made, io::order::along_x}};

/// A scene in an order. That asked for last is kept, as Google Benchmark comes back for it.
bench::scene<float> const& scene_of(io::scene_kind const& kind, scene_order const& order, std::size_t part) {
  static std::unique_ptr<bench::scene<float>> last;
  static std::string last_name;
  std::string const name = std::string(kind.name) + "/" + order.name;
  if (last_name == name) return *last;
  last.reset();
  auto const part_of = [&](std::size_t n) { return std::max<std::size_t>(n / part, 1000); };
  io::scene s = kind.make(part_of(kind.spheres), part_of(kind.triangles), 0);
  io::order_vertices(s, order.vertices, 0);
  io::order_triangles(s, order.triangles, 0);
  io::order_spheres(s, order.spheres, 0);
  last = std::make_unique<bench::scene<float>>(s);
  last_name = name;
  return *last;
}

double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void run(benchmark::State& state, io::scene_kind const& kind, scene_order const& order, bool gives_radius,
         std::size_t part, int threads) {
  auto const& scene = scene_of(kind, order, part);
  auto const mesh = scene.mesh();
  auto const spheres = scene.spheres();
  float const radius = scene.largest_radius();
  collide::detector<collide::bucket> detector{collide::host(threads)};
  collide::pairs pairs;
  auto const build = [&] { gives_radius ? detector.build(mesh, radius) : detector.build(mesh); };
  build();
  detector.query(spheres, pairs);
  std::vector<double> builds, both, again;
  for (auto _ : state) {
    double const begin = processor_seconds();
    build();
    double const built = processor_seconds();
    detector.query(spheres, pairs);
    double const end = processor_seconds();
    state.SetIterationTime(end - begin);
    detector.query(spheres, pairs);
    again.push_back(processor_seconds() - end);
    builds.push_back(built - begin);
    both.push_back(end - begin);
  }
  auto const least_ms = [](std::vector<double> const& of) { return 1e3 * *std::min_element(of.begin(), of.end()); };
  state.counters["pairs"] = static_cast<double>(pairs.total());
  state.counters["least_ms"] = least_ms(both);
  state.counters["median_ms"] = 1e3 * bench::median(both);
  state.counters["build_ms"] = least_ms(builds);
  state.counters["again_ms"] = least_ms(again);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::size_t const part = argc > 1 ? bench::count_of(argv[1], 1) : 1;
  std::size_t const threads = argc > 2 ? bench::count_of(argv[2], 1) : 1;
  if (part == 0 || threads == 0 || threads > 1024 || argc > 3) {
    std::fputs("usage: order_bench [PART, at least 1 [THREADS]] [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }
  benchmark::AddCustomContext("threads_at_work", std::to_string(threads));
  for (auto const& kind : io::measured_scenes) {
    for (auto const& order : orders) {
      for (bool const gives_radius : {false, true}) {
        std::string const name =
            "orders/" + std::string(kind.name) + "/" + order.name + (gives_radius ? "/radius" : "/mesh");
        benchmark::RegisterBenchmark(name.c_str(),
                                     [=, &kind, &order](benchmark::State& state) {
                                       run(state, kind, order, gives_radius, part, static_cast<int>(threads));
                                     })
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
      }
    }
  }
  return bench::run();
}
