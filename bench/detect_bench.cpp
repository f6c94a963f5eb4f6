/// \file
/// The six methods of the study on the study's scene and on its scaling series.
///
/// Names are METHOD/BROAD_x_SPACE/PRECISION/SINK/PHASE/SPHERES, at the end with /LAYOUT unless mesh and spheres are
/// packed. Counters: pairs; tests_per_second (pairs of sphere and
/// triangle that were decided, whether or not the broad phase had to look at them); spheres_per_second; over_floor
/// (time over that of reading every centre once, measured in the same process).
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/core/memory.hpp>
#include <collide/sinks/csr.hpp>
#include <collide/spaces/upload.hpp>

#include "io/scenes.hpp"
#include "program.hpp"
#include "stopwatch.hpp"

namespace {

constexpr std::size_t full = io::study_spheres;

/// How vertices and centres lie in memory.
enum class layout { packed, stride_4, three_arrays };
char const* const layout_names[] = {"", "/stride_4", "/three_arrays"};

/// Points in memory of a space.
template <class S>
class points_in {
 public:
  template <class Space>
  points_in(Space const& space, std::vector<double> const& xyz, layout how) {
    std::size_t const n = xyz.size() / 3, width = how == layout::stride_4 ? 4 : 3;
    std::vector<S> arranged(width * n);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        arranged[how == layout::three_arrays ? k * n + i : width * i + k] = static_cast<S>(xyz[3 * i + k]);
    }
    S* const to = memory_.reserve(space.resource(), arranged.size());
    space.copy_from_host(to, arranged.data(), arranged.size());
    view_ =
        how == layout::three_arrays ? collide::points<S>(to, to + n, to + 2 * n, n) : collide::points<S>(to, n, width);
  }

  collide::point_view<S> view() const { return view_; }

 private:
  collide::buffer<S> memory_;
  collide::point_view<S> view_;
};

/// The study's scene in memory of a space.
template <class Space, class S>
struct scene_in {
  points_in<S> vertices, centres;
  collide::buffer<collide::id> corners;
  collide::mesh_view<S> mesh;
  collide::sphere_view<S> spheres;
  S radius;
  double floor = 0;

  scene_in(Space const& space, io::scene const& s, layout how)
      : vertices(space, s.vertices, how), centres(space, s.centres, how), radius{static_cast<S>(s.radius)} {
    collide::id* const to = corners.reserve(space.resource(), s.corners.size());
    space.copy_from_host(to, s.corners.data(), s.corners.size());
    mesh = collide::indexed_mesh(vertices.view(), to, s.triangle_count());
    spheres = collide::spheres_at(centres.view(), radius);
    if (how == layout::packed) floor = bench::floor_of(space, centres.view().address(0), centres.view().size());
  }

  static scene_in& get(std::size_t n, layout how, Space const& space) {
    static std::map<std::pair<std::size_t, layout>, scene_in> made;
    auto const found = made.find({n, how});
    if (found != made.end()) return found->second;
    return made.emplace(std::pair(n, how), scene_in(space, io::study_scene(n), how)).first->second;
  }
};

enum class phase { build, query, both };

char const* name_of(collide::exact) { return "exact"; }
char const* name_of(collide::single_precision) { return "single"; }
char const* name_of(collide::double_precision) { return "double"; }

template <class Broad, class Precision, class Space, class S, class Sink>
void run(benchmark::State& state, phase what, std::size_t n, layout how, Sink sink, Space space) {
  auto& scene = scene_in<Space, S>::get(n, how, space);
  collide::detector<Broad, collide::karabassi<Precision>, Space, S> detector(space);
  auto const mesh = scene.mesh;
  auto const spheres = scene.spheres;
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
    if (scene.floor > 0) state.counters["over_floor"] = each / scene.floor;
  }
  if (scene.floor > 0) state.counters["floor_us"] = scene.floor * 1e6;
  state.counters["cell_width"] = detector.cell_width();
}

template <class Broad, class Precision, class Space, class S, class Sink>
void add(std::string const& method, phase what, std::size_t n, std::string const& sink_name, Sink const& make_sink,
         Space space, layout how = layout::packed) {
  static char const* const phases[] = {"build", "query", "both"};
  std::string const name = method + "/" + name_of(Precision{}) + "/" + sink_name + "/" +
                           phases[static_cast<int>(what)] + "/" + std::to_string(n) +
                           layout_names[static_cast<int>(how)];
  benchmark::RegisterBenchmark(
      name.c_str(),
      [=](benchmark::State& state) { run<Broad, Precision, Space, S>(state, what, n, how, make_sink(), space); })
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

/// Costs of the layouts of mesh and spheres: few spheres, for a test, and the whole scene.
template <class Broad, class Space>
void add_layouts(std::string const& method, Space space) {
  for (std::size_t const n : {std::size_t{1} << 10, full}) {
    for (layout const how : {layout::stride_4, layout::three_arrays}) {
      for (phase const p : {phase::build, phase::query})
        add<Broad, collide::exact, Space, float>(method, p, n, "pairs", pairs, space, how);
    }
  }
}

/// Costs of each sink, on the whole scene.
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

/// Costs of contacts of each type and precision: the sinks are contacts_TYPE, closest_TYPE and pairs_TYPE.
template <class Broad, class S, class Space>
void add_contacts(std::string const& method, std::string const& type, Space space) {
  auto const with = [&](char const* name, auto const& make) {
    std::string const sink = name + ("_" + type);
    add<Broad, collide::exact, Space, S>(method, phase::query, full, sink, make, space);
    add<Broad, collide::double_precision, Space, S>(method, phase::query, full, sink, make, space);
    add<Broad, collide::single_precision, Space, S>(method, phase::query, full, sink, make, space);
  };
  with("pairs", [] { return collide::pairs(); });
  with("contacts", [] { return collide::contacts<S>(); });
  with("closest", [] { return collide::closest<S>(); });
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  collide::host const one(1), all;
  add_series<collide::bucket>("bucket_seq/bucket_x_host", full, one);
  add_sinks<collide::bucket>("bucket_seq/bucket_x_host", one);
  add_layouts<collide::bucket>("bucket_seq/bucket_x_host", one);
  add_contacts<collide::bucket, float>("bucket_seq/bucket_x_host", "float", one);
  add_contacts<collide::bucket, double>("bucket_seq/bucket_x_host", "double", one);
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
    add_layouts<collide::bucket>("bucket_shamem/bucket_x_cuda_shared", blocks);
    add_contacts<collide::bucket, float>("bucket_shamem/bucket_x_cuda_shared", "float", blocks);
    add_contacts<collide::bucket, double>("bucket_shamem/bucket_x_cuda_shared", "double", blocks);
    add_series<collide::all_pairs>("brute_force/all_pairs_x_cuda", full, threads);
    add_series<collide::all_pairs>("brute_force_shamem/all_pairs_x_cuda_shared", full, blocks);
  }
#endif
  return bench::run();
}
