/// \file
/// Costs and gains of many ranks: ranks_bench RANKS SPHERES PARTICLES [TRIANGLES] [OPTION OF GOOGLE BENCHMARK...]
///
/// RANKS is how many threads there are at most; or under mpirun `mpi` or `nccl`, its processes. Names are
/// ranks/SPACE/WORK/KIND:RANKS; threads are from 1 to RANKS, with a GPU each where there are as many. On the host ranks
/// have one thread each; there KIND is also `cores`: one rank with so many threads. WORK is
///   copied   a query of SPHERES spheres of all ranks together, the study's mesh on every rank;
///   divided  the same with that mesh divided among the ranks;
///   ground   the same with hilly ground of TRIANGLES, if given, of which each rank makes a strip;
///   packed   a step of PARTICLES spheres for each rank, that touch each other, with gravity and walls.
/// Times are of the slowest rank, medians of `repeats`, from when all ranks are ready until it is done. The counter
/// cpu_ms is the time of all cores that this process has taken, which others that run beside it change less.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/bucket.cuh>
#include <collide/effects/bounds.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/ranks/distributed_simulation.cuh>
#include <collide/spaces/upload.hpp>

#include "io/on_ranks.hpp"
#include "io/scenes.hpp"
#include "program.hpp"
#include "stopwatch.hpp"

namespace {

constexpr int repeats = 11;
constexpr double radius = 0.01;  // of packed spheres

std::size_t spheres_in_all = 0, particles_of_rank = 0, triangles_of_ground = 0;

/// The part of `n` things that a rank does: from `first` to `end`.
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

/// How long one of the `parts` of f() takes on the slowest rank, and of the cores of this process: medians.
template <class F>
duration time_of(io::any_ranks const& ranks, int parts, F const& f) {
  std::vector<double> seconds, of_cores;
  for (int i = 0; i < repeats; ++i) {
    collide::agree(ranks);
    std::clock_t const begin = std::clock();
    bench::host_stopwatch watch(0);
    double const mine = watch(f);
    seconds.push_back(io::largest(ranks, mine) / parts);
    of_cores.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / parts);
  }
  return {bench::median(seconds), bench::median(of_cores)};
}

/// A query of this rank's spheres; it has all of the mesh, or a part that no other has.
template <class Space>
duration time_query(io::any_ranks const& ranks, Space const& space, io::scene const& scene, share const& triangles,
                    share const& own, bool divides) {
  std::vector<float> const vertices(scene.vertices.begin(), scene.vertices.end());
  std::vector<float> const centres(scene.centres.begin() + static_cast<std::ptrdiff_t>(3 * own.first),
                                   scene.centres.begin() + static_cast<std::ptrdiff_t>(3 * own.end));
  auto const mesh =
      collide::upload(space, collide::indexed_mesh(vertices.data(), vertices.size() / 3,
                                                   scene.corners.data() + 3 * triangles.first, triangles.size()));
  auto const spheres =
      collide::upload(space, collide::spheres_xyz(centres.data(), own.size(), static_cast<float>(scene.radius)));
  collide::distributed<collide::detector<collide::bucket, collide::karabassi<>, Space>, io::any_ranks> detector(ranks,
                                                                                                                space);
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

template <class Space>
duration time_study(io::any_ranks const& ranks, Space const& space, bool divides) {
  io::scene const& scene = study();
  share const all(collide::one_rank(), scene.triangle_count()), part(ranks, scene.triangle_count());
  return time_query(ranks, space, scene, divides ? part : all, share(ranks, spheres_in_all), divides);
}

/// Spheres as wide as triangles, anywhere near hilly ground of which each rank makes a strip.
template <class Space>
duration time_ground(io::any_ranks const& ranks, Space const& space) {
  auto const columns = static_cast<std::size_t>(std::sqrt(static_cast<double>(triangles_of_ground) / 2));
  double const side = 1000, width = side / static_cast<double>(columns);
  share const strip(ranks, columns), own(ranks, spheres_in_all);
  io::scene s;
  s.radius = width / 2;
  io::add_surface(s, strip.size(), columns, false, [&](double across, double along) {
    double const x = width * (static_cast<double>(strip.first) + across * static_cast<double>(strip.size()));
    return io::point{x, side * along, io::hills(x, side * along)};
  });
  io::random_numbers random(own.first);
  s.centres.reserve(3 * own.size());
  for (std::size_t i = 0; i < own.size(); ++i)
    io::add_point(s.centres, {random.between(0, side), random.between(0, side), random.between(-60, 60)});
  share const mine(collide::one_rank(), s.triangle_count()), all(collide::one_rank(), own.size());
  return time_query(ranks, space, s, mine, all, true);
}

/// For so many times the particles of a rank.
template <class Space>
duration time_step(io::any_ranks const& ranks, Space const& space, int times) {
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
  collide::distributed<simulation, io::any_ranks> made(
      ranks, space, sphere_contact::from_restitution(0.5, 2e-3, radius, 1000), gravity{},
      box_walls{{-radius, -radius, -radius}, {far, far, far}, 0.5});
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

/// The reporter of all processes of MPI but the first: it prints nothing.
class silence final : public benchmark::BenchmarkReporter {
  bool ReportContext(Context const&) override { return true; }
  void ReportRuns(std::vector<Run> const&) override {}
};

/// The space of a rank.
template <class Space>
Space space_of([[maybe_unused]] int cores) {
  if constexpr (Space::host_accessible) {
    return Space(cores);
  } else {
    return Space();
  }
}

/// The ranks of a measurement: `size` of them, with so many cores each.
struct crew {
  std::string ranks;  ///< as the option --ranks names them
  int size, cores = 1;
  bool are_processes() const { return io::are_processes(ranks); }
};

template <class Space, class Work>
void add(std::string const& name, crew const& of, Work const& work) {
  int const times = of.size * of.cores;
  std::string const kind = of.cores > 1 ? "cores" : of.are_processes() ? of.ranks : "threads";
  benchmark::RegisterBenchmark(
      (std::string("ranks/") + Space::name() + "/" + name + "/" + kind + ":" + std::to_string(times)).c_str(),
      [=](benchmark::State& state) {
        for (auto _ : state) {
          duration took;
          io::on_ranks(of.ranks, io::device_of<Space>::take, [&](io::any_ranks const& all) {
            duration const mine = work(all, space_of<Space>(of.cores), times);
            if (all.rank() == 0 || of.are_processes()) took = mine;
          });
          state.SetIterationTime(took.seconds);
          state.counters["cpu_ms"] = 1e3 * took.of_cores;
        }
        state.counters["ranks"] = of.size;
        state.counters["spheres"] = static_cast<double>(spheres_in_all);
        if (triangles_of_ground != 0) state.counters["triangles_of_ground"] = static_cast<double>(triangles_of_ground);
        state.counters["particles_of_rank"] = static_cast<double>(particles_of_rank);
      })
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

template <class Space>
void add_all(crew const& of) {
  add<Space>("copied", of, [](auto const& r, Space const& space, int) { return time_study(r, space, false); });
  add<Space>("divided", of, [](auto const& r, Space const& space, int) { return time_study(r, space, true); });
  if (triangles_of_ground != 0)
    add<Space>("ground", of, [](auto const& r, Space const& space, int) { return time_ground(r, space); });
  add<Space>("packed", of, [](auto const& r, Space const& space, int times) { return time_step(r, space, times); });
}

/// Of the host, or of GPUs where there are some.
void add_all(crew const& of) {
  if (!bench::has_gpu()) add_all<collide::host>(of);
#if defined(__CUDACC__)
  if (bench::has_gpu()) add_all<collide::cuda_shared>(of);
#endif
}

/// The number of this process, and how many there are.
std::pair<int, int> place_of([[maybe_unused]] std::string const& ranks) {
#if defined(COLLIDE_HAS_MPI)
  if (io::are_processes(ranks)) {
    collide::mpi_ranks const all;
    return {all.rank(), all.size()};
  }
#endif
  return {0, 1};
}

}  // namespace

int main(int argc, char** argv) try {
  std::string const kind = argc > 1 ? argv[1] : "";
  bool const processes = io::are_processes(kind);
  if (processes) io::check_ranks(kind, bench::has_gpu() ? "cuda_shared" : "host");
  io::rank_session session;
  session.begin(kind, argc, argv);
  auto const [rank, size] = place_of(kind);
  if (rank != 0) {  // files are the first's
    argc = static_cast<int>(
        std::remove_if(argv, argv + argc, [](char const* a) { return std::strncmp(a, "--benchmark_out", 15) == 0; }) -
        argv);
  }
  benchmark::Initialize(&argc, argv);
  int threads = 0;
  if ((argc == 4 || argc == 5) &&
      (processes || (io::parse_number<int>(kind, threads) && threads >= 1 && threads <= 64))) {
    spheres_in_all = bench::count_of(argv[2], 1);
    particles_of_rank = bench::count_of(argv[3], 1);
    if (argc == 5) triangles_of_ground = bench::count_of(argv[4], 2);
  }
  if (spheres_in_all == 0 || particles_of_rank == 0 || (argc == 5 && triangles_of_ground == 0)) {
    std::fputs("usage: ranks_bench N|mpi|nccl SPHERES PARTICLES [TRIANGLES] [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }
  if (processes) add_all({kind, size});
  for (int n = 1; n <= threads; ++n) {
    add_all({"threads:" + std::to_string(n), n});
    if (!bench::has_gpu() && n > 1) add_all<collide::host>({"threads:1", 1, n});
  }
  if (rank == 0) return bench::run();
  silence silent;
  benchmark::RunSpecifiedBenchmarks(&silent);
  return 0;
} catch (std::exception const& e) {
  std::fprintf(stderr, "ranks_bench: %s\n", e.what());
  return 1;
}
