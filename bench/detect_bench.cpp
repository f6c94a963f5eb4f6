/// \file
/// The six methods of the study on the study's scene and on its scaling series.
///
/// Names are METHOD/BROAD_x_SPACE/PRECISION/SINK/PHASE/SPHERES. Counters: pairs; tests_per_second (pairs of sphere and
/// triangle that were decided, whether or not the broad phase had to look at them); spheres_per_second; over_floor
/// (time over that of reading every centre once, measured in the same process).
#include <map>
#include <string>

#include <benchmark/benchmark.h>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/csr.hpp>
#include <collide/upload.hpp>

#include "io/scenes.hpp"
#include "program.hpp"
#include "stopwatch.hpp"

namespace {

constexpr std::size_t full = io::study_spheres;

/// The study's scene in memory of a space.
template <class Space, class S>
struct scene_in {
  Space space;
  collide::uploaded_mesh<S> mesh;
  collide::uploaded_spheres<S> spheres;
  S radius;
  double floor;

  static scene_in& get(std::size_t n, Space const& space) {
    static std::map<std::size_t, scene_in> made;
    auto const found = made.find(n);
    if (found != made.end()) return found->second;
    io::scene const s = io::study_scene(n);
    std::vector<S> const vertices(s.vertices.begin(), s.vertices.end()), centres(s.centres.begin(), s.centres.end());
    auto const mesh = collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count());
    auto const spheres = collide::spheres_xyz(centres.data(), n, static_cast<S>(s.radius));
    scene_in in{space, collide::upload(space, mesh), collide::upload(space, spheres), static_cast<S>(s.radius), 0};
    in.floor = bench::floor_of(space, in.spheres.view().x(0), n);
    return made.emplace(n, std::move(in)).first->second;
  }
};

enum class phase { build, query, both };

char const* name_of(collide::exact) { return "exact"; }
char const* name_of(collide::single_precision) { return "single"; }
char const* name_of(collide::double_precision) { return "double"; }

template <class Broad, class Precision, class Space, class S, class Sink>
void run(benchmark::State& state, phase what, std::size_t n, Sink sink, Space space) {
  auto& scene = scene_in<Space, S>::get(n, space);
  collide::detector<Broad, collide::karabassi<Precision>, Space, S> detector(space);
  auto const mesh = scene.mesh.view();
  auto const spheres = scene.spheres.view();
  bench::stopwatch<Space> watch(space);
  auto const build = [&] { detector.build(mesh, scene.radius); };
  auto const query = [&] { detector.query(spheres, sink); };
  build();
  query();
  query();
  double seconds = 0;
  for (auto _ : state) {
    double const t = watch([&] {
      if (what != phase::query) build();
      if (what != phase::build) query();
    });
    state.SetIterationTime(t);
    seconds += t;
  }
  auto const pairs = detector.query(spheres, collide::count()).total();
  double const each = seconds / static_cast<double>(state.iterations());
  state.counters["pairs"] = static_cast<double>(pairs);
  if (what != phase::build) {
    state.counters["tests_per_second"] = static_cast<double>(n) * static_cast<double>(mesh.size()) / each;
    state.counters["spheres_per_second"] = static_cast<double>(n) / each;
    state.counters["over_floor"] = each / scene.floor;
  }
  state.counters["floor_us"] = scene.floor * 1e6;
  state.counters["cell_width"] = detector.cell_width();
}

template <class Broad, class Precision, class Space, class S, class Sink>
void add(std::string const& method, phase what, std::size_t n, std::string const& sink_name, Sink const& make_sink,
         Space space) {
  static char const* const phases[] = {"build", "query", "both"};
  std::string const name = method + "/" + name_of(Precision{}) + "/" + sink_name + "/" +
                           phases[static_cast<int>(what)] + "/" + std::to_string(n);
  benchmark::RegisterBenchmark(
      name.c_str(),
      [=](benchmark::State& state) { run<Broad, Precision, Space, S>(state, what, n, make_sink(), space); })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

auto const pairs = [] { return collide::pairs(); };

/// A method on the scaling series and, up to `largest` spheres, the whole scene: build, query and both.
template <class Broad, class Space>
void add_series(std::string const& method, std::size_t largest, Space space) {
  using collide::exact;
  for (std::size_t n = 1 << 10; n <= std::min<std::size_t>(largest, 1 << 20); n *= 2) {
    add<Broad, exact, Space, float>(method, phase::both, n, "pairs", pairs, space);
    add<Broad, exact, Space, float>(method, phase::query, n, "pairs", pairs, space);
  }
  if (largest < full) return;
  for (phase const p : {phase::build, phase::query, phase::both}) {
    add<Broad, exact, Space, float>(method, p, full, "pairs", pairs, space);
  }
  add<Broad, collide::single_precision, Space, float>(method, phase::both, full, "pairs", pairs, space);
  add<Broad, collide::double_precision, Space, float>(method, phase::both, full, "pairs", pairs, space);
}

/// What each sink costs, on the whole scene.
template <class Broad, class Space>
void add_sinks(std::string const& method, Space space) {
  auto const with = [&](char const* name, auto const& make) {
    add<Broad, collide::exact, Space, float>(method, phase::query, full, name, make, space);
  };
  with("canonical", [] { return collide::pairs(collide::order::canonical); });
  with("count", [] { return collide::count(); });
  with("any", [] { return collide::any_hit(); });
  with("contacts", [] { return collide::contacts<float>(); });
  with("closest", [] { return collide::closest<float>(); });
  with("csr", [] { return collide::csr(); });
  with("canonical_csr", [] { return collide::csr(collide::order::canonical); });
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  collide::host const one(1), all;
  add_series<collide::bucket>("bucket_seq/bucket_x_host", full, one);
  add_sinks<collide::bucket>("bucket_seq/bucket_x_host", one);
  if (all.threads() > 1) {
    std::string const name = "bucket_seq/bucket_x_host_" + std::to_string(all.threads()) + "_threads";
    add<collide::bucket, collide::exact, collide::host, float>(name, phase::both, full, "pairs", pairs, all);
  }
  add_series<collide::all_pairs>("brute_force_seq/all_pairs_x_host", 1 << 13, one);

#if defined(__CUDACC__)
  if (bench::has_gpu()) {
    collide::cuda const threads;
    collide::cuda_shared const blocks;
    add_series<collide::bucket>("bucket/bucket_x_cuda", full, threads);
    add_series<collide::bucket>("bucket_shamem/bucket_x_cuda_shared", full, blocks);
    add_sinks<collide::bucket>("bucket_shamem/bucket_x_cuda_shared", blocks);
    add_series<collide::all_pairs>("brute_force/all_pairs_x_cuda", full, threads);
    add_series<collide::all_pairs>("brute_force_shamem/all_pairs_x_cuda_shared", full, blocks);
  }
#endif
  return bench::run();
}
