/// \file
/// The scenes that libraries are compared on: scenes_bench [PART] [OPTION OF GOOGLE BENCHMARK...]
///
/// Names are scenes/SCENE/BROAD_x_SPACE/PHASE, with the scenes of io/scenes.hpp. PHASE is
///   first  the build and the first query of a new detector, into the sink `pairs`, memory included;
///   both   build, and the first query after it, of a detector that has its memory;
///   query  the sixth query of a build, and later ones.
/// Arrays are in memory of the space, and so are the pairs. Counters: spheres, triangles, pairs; memory_mb, the most
/// that detector and pairs have had at a time; bound_us, the time of reading in one go as many bytes as the spheres,
/// the mesh and the pairs have, measured in the same process; over_bound. PART divides the numbers of spheres and of
/// triangles, down to a thousand, to try things out. `all_pairs` is left out where it would take minutes.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <memory_resource>
#include <string>

#include <benchmark/benchmark.h>

#include <collide/all_pairs.cuh>
#include <collide/automatic.cuh>
#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/spaces/upload.hpp>

#include "io/counting.hpp"
#include "io/scenes.hpp"
#include "program.hpp"
#include "scene.hpp"
#include "stopwatch.hpp"

namespace {

enum class phase { first, both, query };
constexpr phase phases[] = {phase::first, phase::both, phase::query};
constexpr char const* phase_names[] = {"first", "both", "query"};

collide::host with_memory(collide::host const& space, std::pmr::memory_resource* memory) {
  return collide::host(space.threads(), memory);
}
#if defined(__CUDACC__)
collide::cuda_shared with_memory(collide::cuda_shared const& space, std::pmr::memory_resource* memory) {
  return collide::cuda_shared(space.stream(), memory);
}
#endif

/// A part of a number of spheres or of triangles.
std::size_t part_of(std::size_t n, std::size_t part) { return std::max<std::size_t>(n / part, 1000); }

/// A scene in memory of a space.
template <class Space>
struct scene_in {
  collide::uploaded_mesh<float> mesh;
  collide::uploaded_spheres<float> spheres;
  std::size_t bytes;  ///< of the arrays

  scene_in(bench::scene<float> const& from, Space const& space)
      : mesh{collide::upload(space, from.mesh())},
        spheres{collide::upload(space, from.spheres())},
        bytes{sizeof(float) * (from.vertices.size() + from.corners.size() + from.centres.size() + from.radii.size())} {}

  /// The scene asked for last is kept: Google Benchmark comes back for it, and large ones take long to make.
  static scene_in const& get(io::scene_kind const& kind, std::size_t part, Space const& space) {
    static std::unique_ptr<scene_in> made;
    static io::scene_kind const* made_of = nullptr;
    if (made_of == &kind) return *made;
    bench::scene<float> const from(kind.make(part_of(kind.spheres, part), part_of(kind.triangles, part), 0));
    made.reset();
    made = std::make_unique<scene_in>(from, space);
    made_of = &kind;
    return *made;
  }
};

/// Seconds of reading so many bytes in one go.
template <class Space>
double time_of_reading(std::size_t bytes, Space const& space) {
  std::size_t const n = bytes / (3 * sizeof(float)) + 1;
  collide::buffer<float> memory;
  float* const from = memory.reserve(space.resource(), 3 * n);
  space.fill(from, 0, 3 * n * sizeof(float));
  return bench::floor_of(space, from, n);
}

template <class Broad, class Space>
void run(benchmark::State& state, io::scene_kind const& kind, std::size_t part, phase what, Space space) {
  using detector_type = collide::detector<Broad, collide::karabassi<>, Space>;
  auto const& scene = scene_in<Space>::get(kind, part, space);
  auto const mesh = scene.mesh.view();
  auto const spheres = scene.spheres.view();
  io::counting_resource memory(space.resource());
  Space const counted = with_memory(space, &memory);
  auto detector = std::make_unique<detector_type>(counted);
  auto pairs = std::make_unique<collide::pairs>();
  auto const build = [&] { detector->build(mesh); };
  auto const query = [&] { detector->query(spheres, *pairs); };
  auto const renew = [&] {
    detector.reset();
    pairs.reset();
    detector = std::make_unique<detector_type>(counted);
    pairs = std::make_unique<collide::pairs>();
  };
  auto const work = [&] {
    if (what != phase::query) build();
    query();
  };
  build();
  for (int k = 0; k < 4; ++k) query();
  work();
  bench::stopwatch<Space> watch(space);
  double seconds = 0;
  for (auto _ : state) {
    if (what == phase::first) renew();
    double const t = watch(work);
    state.SetIterationTime(t);
    seconds += t;
  }
  std::size_t const found = pairs->total();
  detector.reset();
  pairs.reset();
  double const bound = time_of_reading(scene.bytes + found * sizeof(collide::pair), space);
  state.counters["spheres"] = static_cast<double>(spheres.size());
  state.counters["triangles"] = static_cast<double>(mesh.size());
  state.counters["pairs"] = static_cast<double>(found);
  state.counters["memory_mb"] = static_cast<double>(memory.peak) * 1e-6;
  state.counters["bound_us"] = bound * 1e6;
  state.counters["over_bound"] = seconds / static_cast<double>(state.iterations()) / bound;
}

template <class Broad, class Space>
void add(io::scene_kind const& kind, std::size_t part, std::string const& broad, Space space) {
  for (phase const what : phases) {
    std::string const name = "scenes/" + std::string(kind.name) + "/" + broad + "_x_" + Space::name() + "/" +
                             phase_names[static_cast<int>(what)];
    benchmark::RegisterBenchmark(name.c_str(),
                                 [=, &kind](benchmark::State& state) { run<Broad>(state, kind, part, what, space); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  }
}

/// Every scene; `all_pairs` where it has at most so many pairs to decide.
template <class Space>
void add_scenes(std::size_t part, double most_decided, Space space) {
  auto const add_scene = [&](io::scene_kind const& kind) {
    add<collide::bucket>(kind, part, "bucket", space);
    add<collide::bvh>(kind, part, "bvh", space);
    add<collide::automatic>(kind, part, "automatic", space);
    double const spheres = static_cast<double>(part_of(kind.spheres, part));
    double const triangles = static_cast<double>(part_of(kind.triangles, part));
    if (spheres * triangles <= most_decided) add<collide::all_pairs>(kind, part, "all_pairs", space);
  };
  for (auto const& kind : io::measured_scenes) add_scene(kind);
  for (auto const& kind : io::needle_scenes) add_scene(kind);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::size_t const part = argc > 1 ? bench::count_of(argv[1], 1) : 1;
  if (part == 0 || argc > 2) {
    std::fputs("usage: scenes_bench [PART, at least 1] [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }
  add_scenes(part, 3e9, collide::host(1));
#if defined(__CUDACC__)
  if (bench::has_gpu()) add_scenes(part, 4e11, collide::cuda_shared());
#endif
  return bench::run();
}
