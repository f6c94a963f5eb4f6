/// \file
/// The bytes that ranks send: traffic_bench RANKS SIDE SPHERES [OPTION OF GOOGLE BENCHMARK...]
///
/// Names are traffic/host/WORK/N/RANKS, for 1, 2, 4, ... to RANKS threads. WORK is
///   packed   steps of particles that touch each other, about N = SIDE^3 on each rank, and those of an eighth and of a
///            sixty-fourth of that;
///   flying   the same of particles far apart, which fly;
///   copied   a query of N = SPHERES spheres of each rank and of an eighth of that, the study's mesh on every rank;
///   divided  the same with that mesh divided among the ranks.
/// A rank's part of space is a cube: two ranks stand side by side, four in a square, eight in a cube. Counters are of
/// one step or query and one rank: means of all ranks, and `most`, the largest mean of a rank. Times mean nothing.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <benchmark/benchmark.h>

#include <collide/bucket.cuh>
#include <collide/effects/bounds.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/ranks/distributed_simulation.cuh>
#include <collide/ranks/thread_ranks.hpp>

#include "counted_ranks.hpp"
#include "io/scenes.hpp"
#include "program.hpp"

namespace {

using collide::thread_ranks;
using ranks_type = bench::counted_ranks<thread_ranks>;
using counters = std::map<std::string, double>;

constexpr double radius = 0.01, reach = 2 * radius * 1.1;  // how far ranks know others' particles
constexpr float dt = 1e-4f;
constexpr int steps = 40;

/// How many ranks stand along each axis.
struct arrangement {
  int along[3] = {1, 1, 1};
  explicit arrangement(int ranks) {
    for (int k = 0; ranks > 1; ranks /= 2, ++k) along[k % 3] *= 2;
  }
};

/// The particles of a rank's cube, and the box of all cubes.
struct particles {
  std::vector<float> centres, velocities;
  Eigen::Vector3d lower, box;
  double spacing, length;

  particles(int rank, int ranks, std::size_t side, bool fly)
      : spacing{(fly ? 4 : 1.98) * radius}, length{spacing * static_cast<double>(side)} {
    arrangement const all(ranks);
    int const* const n = all.along;
    lower = length * Eigen::Vector3d(rank % n[0], rank / n[0] % n[1], rank / n[0] / n[1]);
    box = length * Eigen::Vector3d(n[0], n[1], n[2]);
    fill(rank, static_cast<int>(side), fly);
  }

 private:
  /// A cubic lattice that stands askew, so that no layer of it lies along a side. What flies is not quite in its
  /// places.
  void fill(int rank, int side, bool fly) {
    std::mt19937 engine(static_cast<unsigned>(rank));
    std::uniform_real_distribution<double> uniform(-1, 1);
    Eigen::Matrix3d const turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    Eigen::Vector3d const middle = turn.transpose() * (lower + length / 2 * Eigen::Vector3d::Ones()) / spacing;
    for (int i = -side; i <= side; ++i)
      for (int j = -side; j <= side; ++j)
        for (int k = -side; k <= side; ++k) {
          Eigen::Vector3d const x = spacing * (turn * (middle.array().round().matrix() + Eigen::Vector3d(i, j, k)));
          Eigen::Array3d const in = (x - lower).array();
          if (in.minCoeff() < 0 || in.maxCoeff() >= length) continue;
          for (int c = 0; c < 3; ++c) {
            centres.push_back(static_cast<float>(x[c] + (fly ? radius * uniform(engine) : 0)));
            velocities.push_back(static_cast<float>(fly ? uniform(engine) : 0));
          }
        }
  }
};

/// Means over steps of what this rank sends. `copies_bytes` of copies of particles, `moved_bytes` of all else.
counters of_steps(thread_ranks const& threads, std::size_t side, bool fly) {
  using collide::box_walls, collide::gravity, collide::sphere_contact;
  using simulation = collide::simulation<collide::detector<collide::bucket>, sphere_contact, gravity, box_walls>;
  particles const mine(threads.rank(), threads.size(), side, fly);
  bench::traffic sent;
  Eigen::Vector3d const far = mine.box.array() + radius;
  collide::distributed<simulation, ranks_type> made(
      ranks_type(threads, sent), collide::host(1), sphere_contact::from_restitution(0.5, 2e-3, radius, 1000), gravity{},
      box_walls{{-radius, -radius, -radius}, {far[0], far[1], far[2]}, 0.5});
  made.set(collide::spheres_xyz(mine.centres.data(), mine.centres.size() / 3, static_cast<float>(radius)),
           mine.velocities.data());
  made.steps(5, dt);
  counters found;
  double own = 0;
  for (int i = 0; i < steps; ++i) {
    sent = {};
    made.step(dt);
    own += static_cast<double>(made.local().size());
    bool const rebuilds = sent.exchanges > 1;  // copies are sent, others move, and copies are sent again
    std::uint64_t const copies = sent.last_bytes + (rebuilds ? sent.first_bytes : 0);
    found["copies_bytes"] += static_cast<double>(copies);
    found["moved_bytes"] += static_cast<double>(sent.exchanged_bytes - copies);
    found["rebuilds"] += rebuilds;
  }
  sent = {};
  made.steps(steps, dt);
  found["reductions"] = static_cast<double>(sent.reductions);
  found["reduced_bytes"] = static_cast<double>(sent.reduced_bytes);
  found["messages"] = static_cast<double>(sent.messages);
  for (auto& [name, sum] : found) sum /= steps;
  found["particles"] = own / steps;
  found["layers_expected"] = reach / mine.spacing;
  return found;
}

/// The bytes that this rank sends in a query.
counters of_query(thread_ranks const& threads, std::size_t n, bool divides) {
  auto const ranks = static_cast<std::size_t>(threads.size()), rank = static_cast<std::size_t>(threads.rank());
  io::scene const scene = io::study_scene(n * ranks);
  std::vector<float> const vertices(scene.vertices.begin(), scene.vertices.end());
  std::vector<float> const centres(scene.centres.begin() + static_cast<std::ptrdiff_t>(3 * n * rank),
                                   scene.centres.begin() + static_cast<std::ptrdiff_t>(3 * n * (rank + 1)));
  std::size_t const triangles = scene.triangle_count(), first = divides ? triangles * rank / ranks : 0,
                    end = divides ? triangles * (rank + 1) / ranks : triangles;
  auto const mesh =
      collide::indexed_mesh(vertices.data(), vertices.size() / 3, scene.corners.data() + 3 * first, end - first);
  bench::traffic sent;
  collide::distributed<collide::detector<collide::bucket>, ranks_type> detector(ranks_type(threads, sent),
                                                                                collide::host(1));
  counters found;
  if (divides) {
    detector.build(mesh, collide::divided);
    found["build_bytes"] = static_cast<double>(sent.exchanged_bytes);
  } else {
    detector.build(mesh, collide::on_every_rank);
  }
  sent = {};
  collide::pairs pairs;
  detector.query(collide::spheres_xyz(centres.data(), n, static_cast<float>(scene.radius)), pairs);
  found["query_bytes"] = static_cast<double>(sent.exchanged_bytes);
  found["reductions"] = static_cast<double>(sent.reductions);
  found["reduced_bytes"] = static_cast<double>(sent.reduced_bytes);
  found["messages"] = static_cast<double>(sent.messages);
  found["particles"] = static_cast<double>(n);
  found["pairs"] = static_cast<double>(pairs.size());
  return found;
}

template <class Work>
void add(std::string const& work, std::size_t n, int ranks, Work const& f) {
  std::string const name = "traffic/host/" + work + "/" + std::to_string(n) + "/" + std::to_string(ranks);
  benchmark::RegisterBenchmark(
      name.c_str(),
      [=](benchmark::State& state) {
        for (auto _ : state) {
          std::vector<counters> of(static_cast<std::size_t>(ranks));
          thread_ranks::run(ranks, [&](thread_ranks const& r) { of[static_cast<std::size_t>(r.rank())] = f(r); });
          for (counters const& one : of) {
            for (auto const& [what, value] : one) {
              state.counters[what] += value / ranks;
              if (what == "copies_bytes" || what == "query_bytes")
                state.counters["most"] = std::max(double(state.counters["most"]), value);
            }
          }
        }
      })
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::size_t most = 0;
  bool const counts = argc == 4 && io::parse_number<std::size_t>(argv[1], most) && most >= 1 && most <= 64;
  std::size_t const side = counts ? bench::count_of(argv[2], 4) : 0, spheres = counts ? bench::count_of(argv[3], 8) : 0;
  if (side == 0 || side > 1000 || spheres == 0) {
    std::fputs("usage: traffic_bench RANKS SIDE SPHERES [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }
  for (int ranks = 1; ranks <= static_cast<int>(most); ranks *= 2) {
    for (std::size_t const s : {side / 4, side / 2, side}) {
      for (bool const fly : {false, true}) {
        add(fly ? "flying" : "packed", s * s * s, ranks, [=](thread_ranks const& r) { return of_steps(r, s, fly); });
      }
    }
    for (std::size_t const n : {spheres / 8, spheres}) {
      for (bool const divides : {false, true}) {
        add(divides ? "divided" : "copied", n, ranks, [=](thread_ranks const& r) { return of_query(r, n, divides); });
      }
    }
  }
  return bench::run();
}
