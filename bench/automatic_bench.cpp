/// \file
/// Where `all_pairs` is faster than `bucket`, and whether `automatic` knows it:
/// automatic_bench [LARGEST] [OPTION OF GOOGLE BENCHMARK...]
///
/// Names are automatic/PHASE/RADII/SPACE/TRIANGLES/SPHERES: the study's scene of so many triangles. PHASE is `detect`,
/// build and query, or `query`, with everything prepared for the radius. RADII are `small`, the study's, or `wide`: as
/// wide as a triangle, so that a sphere at the mesh touches many. The three are timed in turn; counters: all_pairs_ms,
/// bucket_ms, automatic_ms, over_best. LARGEST bounds spheres and triangles.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/automatic.cuh>
#include <collide/spaces/upload.hpp>

#include "io/scenes.hpp"
#include "program.hpp"
#include "race.hpp"

namespace {

template <class Broad, class Space>
bench::contestant contestant_of(std::string const& name, Space const& space, collide::mesh_view<float> mesh,
                                collide::sphere_view<float> spheres, bool builds) {
  using detector_type = collide::detector<Broad, collide::karabassi<>, Space>;
  auto const detector = std::make_shared<detector_type>(space);
  auto const pairs = std::make_shared<collide::pairs>();
  detector->build(mesh, spheres.common_radius());
  return {name, [=] {
            if (builds) detector->build(mesh);
            detector->query(spheres, *pairs);
          }};
}

template <class Space>
void run(benchmark::State& state, Space const& space, bool builds, bool wide, std::size_t triangles,
         std::size_t count) {
  io::scene const from = io::study_scene(count, triangles);
  std::vector<float> const vertices(from.vertices.begin(), from.vertices.end());
  std::vector<float> const centres(from.centres.begin(), from.centres.end());
  double const widening =
      wide ? std::sqrt(static_cast<double>(io::study_triangles) / static_cast<double>(triangles)) : 1;
  auto const radius = static_cast<float>(3 * widening);
  auto const mesh = collide::upload(
      space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, from.corners.data(), from.triangle_count()));
  auto const spheres = collide::upload(space, collide::spheres_xyz(centres.data(), count, radius));
  auto const contestants =
      bench::warmed({contestant_of<collide::all_pairs>("all_pairs", space, mesh.view(), spheres.view(), builds),
                     contestant_of<collide::bucket>("bucket", space, mesh.view(), spheres.view(), builds),
                     contestant_of<collide::automatic>("automatic", space, mesh.view(), spheres.view(), builds)});
  if constexpr (Space::host_accessible) {  // one thread: other programs do not count
    bench::processor_stopwatch watch;
    bench::race_by(state, watch, contestants);
  } else {
    bench::race(state, space, contestants);
  }
  auto& counters = state.counters;
  counters["triangles"] = static_cast<double>(from.triangle_count());
  counters["spheres"] = static_cast<double>(count);
  counters["over_best"] =
      counters["automatic_ms"].value / std::min(counters["all_pairs_ms"].value, counters["bucket_ms"].value);
}

template <class Space>
void add(Space const& space, std::size_t largest) {
  for (int kind = 0; kind < 4; ++kind) {
    bool const builds = kind < 2, wide = kind % 2 != 0;
    for (std::size_t const triangles : {16, 64, 256, 1024, 4096, 16384, 65536}) {
      for (std::size_t const spheres : {100, 1000, 10000, 100000, 1000000}) {
        bool const is_long = Space::host_accessible && triangles * spheres > 10'000'000'000;
        if (triangles > largest || spheres > largest || is_long) continue;
        std::string const name = std::string("automatic/") + (builds ? "detect/" : "query/") +
                                 (wide ? "wide/" : "small/") + Space::name() + "/" + std::to_string(triangles) + "/" +
                                 std::to_string(spheres);
        benchmark::RegisterBenchmark(
            name.c_str(), [=](benchmark::State& state) { run(state, space, builds, wide, triangles, spheres); })
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::size_t const largest = argc > 1 ? bench::count_of(argv[1], 1024) : 1 << 24;
  if (largest == 0 || argc > 2) {
    std::fputs("usage: automatic_bench [LARGEST, at least 1024] [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }
  add(collide::host(1), largest);
#if defined(__CUDACC__)
  if (bench::has_gpu()) {
    add(collide::cuda_shared(), largest);
    add(collide::cuda(), largest);
  }
#endif
  return bench::run();
}
