/// \file
/// How the time of a whole detection grows: growth_bench [LARGEST] [OPTION OF GOOGLE BENCHMARK...]
///
/// Names are growth/AXIS/BROAD_x_SPACE/VALUE, on scenes around the study's torus:
///   spheres    so many of radius 3, uniform in the study's cube;
///   triangles  so many, with radii that shrink with them, so that a sphere touches about as many;
///   hits       the radius, in hundredths, of spheres on the surface: from hardly a triangle to a thousand for each;
///   radii      the largest radius, 30, over the smallest; as many spheres of each order of magnitude;
///   cluster    the spheres are in a cube of this half-width around a point of the surface, in the end in one cell.
/// The time is that of build and query, into the sink `pairs`. Counters: spheres, triangles, pairs; ns_per_item, the
/// time over their sum: linear growth is a line that does not rise. LARGEST bounds spheres and triangles; 100000000
/// triangles take 10 s to make, 10 GB of host memory and 20 GB of the device's.
#include <cstdio>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/bucket.cuh>
#include <collide/spaces/upload.hpp>

#include "io/scenes.hpp"
#include "program.hpp"
#include "scene.hpp"
#include "stopwatch.hpp"

namespace {

using make_scene = io::scene (*)(std::size_t value, std::size_t largest);

std::size_t at_most(std::size_t n, std::size_t largest) { return n < largest ? n : largest; }

io::scene of_spheres(std::size_t value, std::size_t) { return io::study_scene(value); }

io::scene of_triangles(std::size_t value, std::size_t largest) {
  return io::finer_scene(at_most(1 << 20, largest), value, 0);
}

io::scene of_hits(std::size_t value, std::size_t largest) {
  return io::hits_scene(static_cast<double>(value) / 100, at_most(1 << 15, largest),
                        at_most(io::study_triangles, largest), 0);
}

io::scene of_radii(std::size_t value, std::size_t largest) {
  return io::ratio_scene(static_cast<double>(value), at_most(1 << 17, largest), at_most(io::study_triangles, largest),
                         0);
}

io::scene of_crowd(std::size_t value, std::size_t largest) {
  return io::crowd_scene(static_cast<double>(value), at_most(1 << 18, largest), at_most(io::study_triangles, largest),
                         0);
}

/// The scene of the last measurement is kept: Google Benchmark comes back for it to iterate more often, and large ones
/// take longer to make than to measure.
io::scene const& scene_of(make_scene make, std::size_t value, std::size_t largest) {
  static make_scene made = nullptr;
  static std::size_t value_made = 0;
  static io::scene scene;
  if (made != make || value_made != value) {
    scene = {};
    scene = make(value, largest);
    made = make;
    value_made = value;
  }
  return scene;
}

template <class Space>
void run(benchmark::State& state, Space space, make_scene make, std::size_t value, std::size_t largest) {
  io::scene const& from = scene_of(make, value, largest);
  bench::scene<float> const rounded(from);
  std::size_t const n = from.sphere_count();
  auto const mesh = collide::upload(space, rounded.mesh());
  auto const spheres = collide::upload(space, rounded.spheres());
  collide::detector<collide::bucket, collide::karabassi<>, Space> detector(space);
  collide::pairs pairs;
  auto const detect = [&] {
    if (from.radii.empty()) {
      detector.build(mesh.view(), rounded.largest_radius());
    } else {
      detector.build(mesh.view());
    }
    detector.query(spheres.view(), pairs);
  };
  detect();
  bench::stopwatch<Space> watch(space);
  double seconds = 0;
  for (auto _ : state) {
    double const t = watch(detect);
    state.SetIterationTime(t);
    seconds += t;
  }
  auto const items =
      static_cast<double>(n) + static_cast<double>(from.triangle_count()) + static_cast<double>(pairs.total());
  state.counters["spheres"] = static_cast<double>(n);
  state.counters["triangles"] = static_cast<double>(from.triangle_count());
  state.counters["pairs"] = static_cast<double>(pairs.total());
  state.counters["ns_per_item"] = 1e9 * seconds / static_cast<double>(state.iterations()) / items;
  state.counters["cell_width"] = detector.cell_width();
}

template <class Space>
void add(std::string const& composition, Space space, std::size_t largest) {
  auto const axis = [&](char const* name, make_scene make, std::vector<std::size_t> const& values) {
    for (std::size_t const value : values) {
      std::string const full = std::string("growth/") + name + "/" + composition + "/" + std::to_string(value);
      benchmark::RegisterBenchmark(full.c_str(),
                                   [=](benchmark::State& state) { run(state, space, make, value, largest); })
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  };
  std::vector<std::size_t> spheres, triangles;
  for (std::size_t n = 1 << 10; n <= largest; n *= 4) spheres.push_back(n);
  for (std::size_t n = 1000; n <= largest; n *= 10) triangles.push_back(n);
  axis("spheres", of_spheres, spheres);
  axis("triangles", of_triangles, triangles);
  axis("hits", of_hits, {0, 100, 300, 1000, 3000, 8500});
  axis("radii", of_radii, {1, 3, 10, 30, 100, 300, 1000});
  axis("cluster", of_crowd, {592, 200, 60, 20, 6, 2});
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::size_t const largest = argc > 1 ? bench::count_of(argv[1], 1024) : 1 << 24;
  if (largest == 0 || argc > 2) {
    std::fputs("usage: growth_bench [LARGEST, at least 1024] [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }
  add("bucket_x_host", collide::host(1), largest);
#if defined(__CUDACC__)
  if (bench::has_gpu()) {
    add("bucket_x_cuda_shared", collide::cuda_shared(), largest);
  }
#endif
  return bench::run();
}
