/// \file
/// What many ranks cost and gain: ranks_bench RANKS SPHERES PARTICLES [OPTION OF GOOGLE BENCHMARK...]
///
/// Names are ranks/SPACE/WORK/KIND:RANKS, for threads from 1 to RANKS, a GPU each where there are as many; under mpirun
/// (RANKS is then 0) for its processes. On the host ranks have one thread each; there KIND is also `cores`: one rank
/// with so many threads. WORK is
///   copied   a query of SPHERES spheres of all ranks together, the study's mesh on every rank;
///   divided  the same with that mesh divided among the ranks;
///   packed   a step of PARTICLES spheres for each rank, that touch each other, with gravity and walls.
/// Times are of the slowest rank, medians of `repeats`, from when all ranks are ready until all are done. The counter
/// cpu_ms is the time of all cores that this process has taken, which others that run beside it change less.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/bucket.cuh>
#include <collide/effects/bounds.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/ranks/distributed_simulation.cuh>
#include <collide/ranks/thread_ranks.hpp>
#include <collide/upload.hpp>
#if defined(COLLIDE_HAS_MPI)
#include <collide/ranks/mpi.hpp>
#endif

#include "io/scenes.hpp"
#include "program.hpp"
#include "stopwatch.hpp"

namespace {

constexpr int repeats = 11;
constexpr double radius = 0.01;  // of packed spheres

std::size_t spheres_in_all = 0, particles_of_rank = 0;

/// What a rank does of `n` things: from `first` to `end`.
struct share {
  std::size_t first, end;
  template <class Ranks>
  share(Ranks const& ranks, std::size_t n)
      : first{n * static_cast<std::size_t>(ranks.rank()) / static_cast<std::size_t>(ranks.size())},
        end{n * static_cast<std::size_t>(ranks.rank() + 1) / static_cast<std::size_t>(ranks.size())} {}
  std::size_t size() const { return end - first; }
};

/// The study's scene, made once.
io::scene const& study() {
  static io::scene const made = io::study_scene(spheres_in_all);
  return made;
}

/// Seconds on the clock, and of all cores that work.
struct duration {
  double seconds = 0, of_cores = 0;
};

/// How long one of the `parts` of f() takes on all ranks: medians.
template <class Ranks, class F>
duration time_of(Ranks const& ranks, int parts, F const& f) {
  std::vector<double> seconds, of_cores;
  for (int i = 0; i < repeats; ++i) {
    agree(ranks);
    std::clock_t const begin = std::clock();
    bench::host_stopwatch watch(0);
    seconds.push_back(watch([&] {
                        f();
                        agree(ranks);
                      }) /
                      parts);
    of_cores.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / parts);
  }
  return {bench::median(seconds), bench::median(of_cores)};
}

template <class Ranks, class Space>
duration time_query(Ranks const& ranks, Space const& space, bool divides) {
  io::scene const& scene = study();
  share const triangles(ranks, scene.triangle_count()), own(ranks, spheres_in_all);
  std::vector<float> const vertices(scene.vertices.begin(), scene.vertices.end());
  std::vector<float> const centres(scene.centres.begin() + static_cast<std::ptrdiff_t>(3 * own.first),
                                   scene.centres.begin() + static_cast<std::ptrdiff_t>(3 * own.end));
  share const all(collide::one_rank(), scene.triangle_count()), part = divides ? triangles : all;
  auto const mesh = collide::upload(space, collide::indexed_mesh(vertices.data(), vertices.size() / 3,
                                                                 scene.corners.data() + 3 * part.first, part.size()));
  auto const spheres =
      collide::upload(space, collide::spheres_xyz(centres.data(), own.size(), static_cast<float>(scene.radius)));
  collide::distributed<collide::detector<collide::bucket, collide::karabassi<>, Space>, Ranks> detector(ranks, space);
  if (divides) {
    detector.build(mesh.view(), collide::divided);
  } else {
    detector.build(mesh.view(), collide::on_every_rank);
  }
  collide::pairs found;
  return time_of(ranks, 1, [&] {
    detector.query(spheres.view(), found);
    space.synchronize();
  });
}

/// For so many times the particles of a rank.
template <class Ranks, class Space>
duration time_step(Ranks const& ranks, Space const& space, int times) {
  using collide::box_walls, collide::gravity, collide::sphere_contact;
  std::size_t const n = particles_of_rank * static_cast<std::size_t>(times);
  auto const side = static_cast<std::size_t>(std::cbrt(static_cast<double>(n))) + 1;
  share const own(ranks, n);
  std::vector<float> centres;
  centres.reserve(3 * own.size());
  for (std::size_t i = own.first; i < own.end; ++i)
    for (std::size_t const at : {i % side, i / side % side, i / side / side})
      centres.push_back(static_cast<float>(1.98 * radius) * static_cast<float>(at));
  double const far = 1.98 * radius * static_cast<double>(side);
  using simulation = collide::simulation<collide::detector<collide::bucket, collide::karabassi<>, Space>,
                                         sphere_contact, gravity, box_walls>;
  collide::distributed<simulation, Ranks> made(ranks, space, sphere_contact::from_restitution(0.5, 2e-3, radius, 1000),
                                               gravity{}, box_walls{{-radius, -radius, -radius}, {far, far, far}, 0.5});
  {
    auto const spheres =
        collide::upload(space, collide::spheres_xyz(centres.data(), own.size(), static_cast<float>(radius)));
    made.set(spheres.view());
  }
  made.steps(3, 1e-4f);
  return time_of(ranks, 5, [&] {
    made.steps(5, 1e-4f);
    space.synchronize();
  });
}

/// What the processes of MPI print but for the first: nothing.
class silence final : public benchmark::BenchmarkReporter {
  bool ReportContext(Context const&) override { return true; }
  void ReportRuns(std::vector<Run> const&) override {}
};

/// Calls f(ranks) on so many threads, or on the processes of MPI if that is 0.
template <class F>
void on_ranks(int threads, F const& f) {
#if defined(COLLIDE_HAS_MPI)
  if (threads == 0) return f(collide::mpi_ranks());
#endif
  collide::thread_ranks::run(threads, f);
}

/// The space of a rank.
template <class Space, class Ranks>
Space space_of([[maybe_unused]] Ranks const& ranks, [[maybe_unused]] int cores) {
  if constexpr (Space::host_accessible) {
    return Space(cores);
  } else {
#if defined(__CUDACC__)
    collide::cuda_check(cudaSetDevice(ranks.rank() % collide::cuda_device_count()), "cudaSetDevice");
#endif
    return Space();
  }
}

/// `threads` ranks, or if that is 0 the `ranks` processes of MPI, with so many cores each.
template <class Space, class Work>
void add(std::string const& name, int threads, int ranks, int cores, Work const& work) {
  int const times = ranks * cores;
  std::string const kind = cores > 1 ? "cores:" : threads == 0 ? "mpi:" : "threads:";
  benchmark::RegisterBenchmark(
      (std::string("ranks/") + Space::name() + "/" + name + "/" + kind + std::to_string(times)).c_str(),
      [=](benchmark::State& state) {
        for (auto _ : state) {
          duration took;
          on_ranks(threads, [&](auto const& all) {
            duration const mine = work(all, space_of<Space>(all, cores), times);
            if (all.rank() == 0 || threads == 0) took = mine;
          });
          state.SetIterationTime(took.seconds);
          state.counters["cpu_ms"] = 1e3 * took.of_cores;
        }
        state.counters["ranks"] = ranks;
        state.counters["spheres"] = static_cast<double>(spheres_in_all);
        state.counters["particles_of_rank"] = static_cast<double>(particles_of_rank);
      })
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

template <class Space>
void add_all(int threads, int ranks, int cores = 1) {
  add<Space>("copied", threads, ranks, cores,
             [](auto const& r, Space const& space, int) { return time_query(r, space, false); });
  add<Space>("divided", threads, ranks, cores,
             [](auto const& r, Space const& space, int) { return time_query(r, space, true); });
  add<Space>("packed", threads, ranks, cores,
             [](auto const& r, Space const& space, int times) { return time_step(r, space, times); });
}

}  // namespace

int main(int argc, char** argv) {
#if defined(COLLIDE_HAS_MPI)
  collide::mpi_session const session(argc, argv);
#endif
  int of_mpi = 1, rank = 0;
#if defined(COLLIDE_HAS_MPI)
  of_mpi = collide::mpi_ranks().size();
  rank = collide::mpi_ranks().rank();
#endif
  if (rank != 0) {  // files are the first's
    argc = static_cast<int>(
        std::remove_if(argv, argv + argc, [](char const* a) { return std::strncmp(a, "--benchmark_out", 15) == 0; }) -
        argv);
  }
  benchmark::Initialize(&argc, argv);
  std::size_t most = 0;
  bool const counts = argc == 4 && io::parse_number<std::size_t>(argv[1], most) && most <= 64;
  if (counts) {
    spheres_in_all = bench::count_of(argv[2], 1);
    particles_of_rank = bench::count_of(argv[3], 1);
  }
  if (spheres_in_all == 0 || particles_of_rank == 0) {
    std::fputs("usage: ranks_bench RANKS SPHERES PARTICLES [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }
  int const last = static_cast<int>(most);
  for (int n = most == 0 ? 0 : 1; n <= last; ++n) {
    if (!bench::has_gpu()) add_all<collide::host>(n, n == 0 ? of_mpi : n);
    if (!bench::has_gpu() && n > 1) add_all<collide::host>(1, 1, n);
#if defined(__CUDACC__)
    if (bench::has_gpu()) add_all<collide::cuda_shared>(n, n == 0 ? of_mpi : n);
#endif
  }
  if (rank == 0) return bench::run();
  silence silent;
  benchmark::RunSpecifiedBenchmarks(&silent);
  return 0;
}
