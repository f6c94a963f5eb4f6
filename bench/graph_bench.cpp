/// \file
/// Time of the GPU itself for a build and a query, without the host: both as CUDA graphs of one launch, into an
/// array of fixed size, beside a graph of one kernel that reads every centre once, in the same run.
///
/// Names are BROAD/PRECISION/PHASE; `build` is what `build` itself does, `both` also fills the grid; `frames` is one of
/// twenty builds and queries that follow each other in a graph, as the frames of a scene in which everything moves,
/// without the launch of the graph.
///
/// least/exact/PHASE is what is left of a query if nothing has to be looked for: `asking` is a query of as many
/// spheres, none of which is near the mesh; `told` is that, and then a kernel that is told all pairs and where to write
/// them, and only tests and writes them; `build_and_told` is a build and that. Counters: pairs; floor_us; over_floor,
/// both of the same number of floors in a graph.
#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/spaces/upload.hpp>

#include "io/scenes.hpp"
#include "program.hpp"
#include "stopwatch.hpp"

#if defined(__CUDACC__)

namespace {

/// A sink that never waits: pairs into the caller's array, which must be large enough.
struct into_array {
  collide::pair* to;
  std::uint64_t capacity;
  collide::detail::hit_counter numbers;

  template <class Space, class Query>
  void run(Space&, Query const& query) {
    query(collide::detail::output{numbers, to, capacity, nullptr});
  }
};

/// The work that a function puts on a stream, as a graph.
class graph {
 public:
  template <class F>
  graph(cudaStream_t stream, F const& f) : stream_{stream} {
    f();  // everything is allocated now
    collide::cuda_check(cudaStreamSynchronize(stream), "cudaStreamSynchronize");
    cudaGraph_t captured = nullptr;
    collide::cuda_check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), "cudaStreamBeginCapture");
    f();
    collide::cuda_check(cudaStreamEndCapture(stream, &captured), "cudaStreamEndCapture");
    collide::cuda_check(cudaGraphInstantiate(&graph_, captured, 0), "cudaGraphInstantiate");
    collide::cuda_check(cudaGraphDestroy(captured), "cudaGraphDestroy");
  }
  graph(graph const&) = delete;
  graph& operator=(graph const&) = delete;
  ~graph() { cudaGraphExecDestroy(graph_); }

  void operator()() const { collide::cuda_check(cudaGraphLaunch(graph_, stream_), "cudaGraphLaunch"); }

 private:
  cudaStream_t stream_;
  cudaGraphExec_t graph_ = nullptr;
};

__global__ void read_centres(float4 const* centres, std::size_t n, float* never) {
  std::size_t const i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i >= n) return;
  float4 const a = centres[3 * i], b = centres[3 * i + 1], c = centres[3 * i + 2];
  float const sum = a.x + a.y + a.z + a.w + b.x + b.y + b.z + b.w + c.x + c.y + c.z + c.w;
  if (sum == 0.12345f) *never = sum;
}

/// Kernel functor of `for_each` over pairs that are told: tests each, as a query does before it finishes what is left
/// open, and writes it where it belongs.
struct test_told {
  collide::mesh_view<float> mesh;
  collide::sphere_view<float> spheres;
  collide::pair const* told;
  collide::pair* to;

  COLLIDE_HD void operator()(std::size_t i) const {
    using stages = collide::detail::filtered_predicate<collide::karabassi<collide::exact>>;
    collide::pair const p = told[i];
    if (stages::filter(mesh[p.triangle], spheres[p.sphere]) != collide::detail::verdict::miss) to[i] = p;
  }
};

struct scene {
  cudaStream_t stream = nullptr;
  collide::cuda_shared space{make_stream(stream)};
  std::optional<collide::uploaded_mesh<float>> mesh;
  std::optional<collide::uploaded_spheres<float>> spheres;
  std::optional<collide::uploaded_spheres<float>>
      far;              ///< the same, except for those near the mesh, which are elsewhere
  collide::pairs told;  ///< all pairs, in canonical order
  collide::buffer<collide::pair> pairs;
  collide::detail::hit_counter_buffer memory_of_total;
  collide::detail::hit_counter total;
  float radius;
  double floor, floor_of_frame;

  static constexpr std::size_t capacity = std::size_t{1} << 20;
  static constexpr int frames_of_graph = 20;

  static scene& get() {
    static scene s;
    return s;
  }

 private:
  scene() {
    io::scene const s = io::study_scene(io::study_spheres);
    std::vector<float> const vertices(s.vertices.begin(), s.vertices.end()),
        centres(s.centres.begin(), s.centres.end());
    radius = static_cast<float>(s.radius);
    mesh = collide::upload(
        space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count()));
    spheres = collide::upload(space, collide::spheres_xyz(centres.data(), centres.size() / 3, radius));
    far = collide::upload(space, collide::spheres_xyz(far_from_mesh(centres).data(), centres.size() / 3, radius));
    collide::detector<collide::bucket, collide::karabassi<collide::exact>, collide::cuda_shared> detector(space);
    told = detector.detect(mesh->view(), spheres->view(), collide::pairs(collide::order::canonical));
    pairs.reserve(space.resource(), capacity);
    total = memory_of_total.begin(space);
    std::size_t const threads = centres.size() / 12;
    auto const* const from = reinterpret_cast<float4 const*>(spheres->view().centres().address(0));
    auto const time_of = [&](int frames) {
      graph const reading(stream, [&] {
        for (int i = 0; i < frames; ++i) {
          read_centres<<<static_cast<unsigned>((threads + 255) / 256), 256, 0, stream>>>(
              from, threads, reinterpret_cast<float*>(total.total));
        }
      });
      bench::stopwatch<collide::cuda_shared> watch(space);
      std::vector<double> times;
      for (int i = 0; i < 101; ++i) times.push_back(watch(reading) / frames);
      std::sort(times.begin(), times.end());
      return times[times.size() / 2];
    };
    floor = time_of(1);
    floor_of_frame = time_of(frames_of_graph);
  }

  /// The same centres, but in place of those near the mesh the one before that is not.
  std::vector<float> far_from_mesh(std::vector<float> centres) {
    collide::detector<collide::bucket, collide::karabassi<collide::single_precision>, collide::cuda_shared> wide(space);
    wide.build(mesh->view(), radius);
    // with cells as wide as here, each cell with triangles is within this of one of them
    auto const reach = static_cast<float>(radius + 4 * wide.cell_width());
    auto const around = collide::upload(space, collide::spheres_xyz(centres.data(), centres.size() / 3, reach));
    std::vector<std::uint8_t> const near = wide.detect(mesh->view(), around.view(), collide::any_hit()).to_host();
    auto const first = static_cast<std::size_t>(std::find(near.begin(), near.end(), 0) - near.begin());
    if (first == near.size()) throw collide::error("graph_bench: all spheres are near the mesh");
    for (std::size_t i = 0, last = first; i < near.size(); ++i) {
      if (near[i] == 0) {
        last = i;
      } else {
        for (std::size_t k = 0; k < 3; ++k) centres[3 * i + k] = centres[3 * last + k];
      }
    }
    return centres;
  }

  static cudaStream_t make_stream(cudaStream_t& stream) {
    collide::cuda_check(cudaStreamCreate(&stream), "cudaStreamCreate");
    return stream;
  }
};

/// Times `frames` times what `frame` puts on the stream, as one graph.
template <class F>
void measure(benchmark::State& state, int frames, std::uint64_t pairs, F const& frame) {
  scene& s = scene::get();
  graph const all(s.stream, [&] {
    for (int i = 0; i < frames; ++i) frame();
  });
  bench::stopwatch<collide::cuda_shared> watch(s.space);
  double seconds = 0;
  for (auto _ : state) {
    double const t = watch(all) / frames;
    state.SetIterationTime(t);
    seconds += t;
  }
  double const floor = frames > 1 ? s.floor_of_frame : s.floor;
  state.counters["pairs"] = static_cast<double>(pairs);
  state.counters["floor_us"] = floor * 1e6;
  state.counters["over_floor"] = seconds / static_cast<double>(state.iterations()) / floor;
}

template <class Broad, class Precision>
void run(benchmark::State& state, bool builds, bool queries, int frames) {
  scene& s = scene::get();
  collide::detector<Broad, collide::karabassi<Precision>, collide::cuda_shared> detector(s.space);
  into_array sink{s.pairs.data(), s.capacity, s.total};
  auto const mesh = s.mesh->view();
  auto const spheres = s.spheres->view();
  detector.build(mesh, s.radius);
  detector.query(spheres, sink);
  std::uint64_t const pairs = s.space.read(s.total.total);
  if (pairs > s.capacity) return state.SkipWithError("the array is too small");
  measure(state, frames, pairs, [&] {
    if (builds) detector.build(mesh, s.radius);
    if (queries) detector.query(spheres, sink);
  });
}

/// The rest of a query if nothing has to be looked for.
void run_least(benchmark::State& state, bool builds, bool told) {
  scene& s = scene::get();
  collide::detector<collide::bucket, collide::karabassi<collide::exact>, collide::cuda_shared> detector(s.space);
  into_array sink{s.pairs.data(), s.capacity, s.total};
  auto const mesh = s.mesh->view();
  auto const far = s.far->view();
  std::size_t const pairs = told ? s.told.size() : 0;
  detector.build(mesh, s.radius);
  detector.query(far, sink);
  if (s.space.read(s.total.total) != 0) return state.SkipWithError("a sphere that should be far touches the mesh");
  s.space.fill(s.pairs.data(), 0xff, s.capacity * sizeof(collide::pair));
  measure(state, 1, pairs, [&] {
    if (builds) detector.build(mesh, s.radius);
    detector.query(far, sink);
    s.space.for_each(pairs, test_told{mesh, s.spheres->view(), s.told.data(), s.pairs.data()});
  });
  std::vector<collide::pair> written(pairs);
  s.space.copy_to_host(written.data(), s.pairs.data(), pairs);
  auto const alike = [](collide::pair a, collide::pair b) { return a.sphere == b.sphere && a.triangle == b.triangle; };
  if (!std::equal(written.begin(), written.end(), s.told.to_host().begin(), alike)) {
    state.SkipWithError("not all pairs that were told were written");
  }
}

void add(std::string const& name, std::function<void(benchmark::State&)> const& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->UseManualTime()->Iterations(1001)->Unit(benchmark::kMicrosecond);
}

template <class Broad, class Precision>
void add_all(std::string const& name) {
  add(name + "/build", [](benchmark::State& state) { run<Broad, Precision>(state, true, false, 1); });
  add(name + "/query", [](benchmark::State& state) { run<Broad, Precision>(state, false, true, 1); });
  add(name + "/both", [](benchmark::State& state) { run<Broad, Precision>(state, true, true, 1); });
  add(name + "/frames",
      [](benchmark::State& state) { run<Broad, Precision>(state, true, true, scene::frames_of_graph); });
}

}  // namespace

#endif

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
#if defined(__CUDACC__)
  if (bench::has_gpu()) {
    add_all<collide::bucket, collide::single_precision>("bucket/single");
    add_all<collide::bucket, collide::exact>("bucket/exact");
    add("least/exact/asking", [](benchmark::State& state) { run_least(state, false, false); });
    add("least/exact/told", [](benchmark::State& state) { run_least(state, false, true); });
    add("least/exact/build_and_told", [](benchmark::State& state) { run_least(state, true, true); });
    add_all<collide::all_pairs, collide::single_precision>("all_pairs/single");
    add_all<collide::all_pairs, collide::exact>("all_pairs/exact");
  }
#endif
  return bench::run();
}
