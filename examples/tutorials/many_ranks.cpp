/// \file
/// Tutorial 6: a mesh that is divided among ranks, which are threads with a GPU each, or processes of MPI.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/ranks/distributed.hpp>
#include <collide/ranks/thread_ranks.hpp>
#include <collide/spaces/upload.hpp>
#if defined(COLLIDE_HAS_MPI)
#include <collide/ranks/mpi.hpp>
#endif

namespace {

constexpr unsigned side = 150;        // the ground has side x side squares of 1 m
constexpr unsigned spheres = 100000;  // in all
constexpr float radius = 0.4f;

/// The first of `n` things that are the part of a rank.
unsigned begin_of(int rank, int size, unsigned n) {
  return static_cast<unsigned>(std::uint64_t{n} * static_cast<unsigned>(rank) / static_cast<unsigned>(size));
}

/// Height of the ground at a corner of the squares.
float height(unsigned x, unsigned y) { return 0.25f * static_cast<float>((x * x + 3 * y) % 7); }

/// Two triangles for each square of the rows from `first` to before `last`.
std::vector<float> ground(unsigned first, unsigned last) {
  std::vector<float> triangles;
  auto const vertex = [&](unsigned x, unsigned y) {
    triangles.insert(triangles.end(), {static_cast<float>(x), static_cast<float>(y), height(x, y)});
  };
  for (unsigned y = first; y < last; ++y) {
    for (unsigned x = 0; x < side; ++x) {
      vertex(x, y), vertex(x + 1, y), vertex(x, y + 1);
      vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1);
    }
  }
  return triangles;
}

/// Centres of the spheres `first` to before `last`: anywhere above the ground, whatever rank they belong to.
std::vector<float> centres_of(unsigned first, unsigned last) {
  std::vector<float> centres;
  std::uint32_t const across = side * 256;
  for (std::uint32_t i = first; i < last; ++i) {
    std::uint32_t const x = i * 2654435761u % across, y = i * 2246822519u % across, z = i % 1024;
    for (std::uint32_t k : {x, y, z}) centres.push_back(static_cast<float>(k) / 256);
  }
  return centres;
}

/// A number for a pair; the sum of those of all pairs does not depend on their order.
std::uint64_t mixed(std::uint64_t sphere, std::uint64_t triangle) {
  std::uint64_t const n = (sphere << 32 | triangle) * 0x9e3779b97f4a7c15u;
  return (n ^ n >> 29) * 0xbf58476d1ce4e5b9u;
}

/// The program of each rank.
template <class Space, class Ranks>
void work(Ranks const& ranks, Space space) {
  int const rank = ranks.rank(), size = ranks.size();
  auto const triangles = ground(begin_of(rank, size, side), begin_of(rank + 1, size, side));
  unsigned const first = begin_of(rank, size, spheres);
  auto const centres = centres_of(first, begin_of(rank + 1, size, spheres));
  auto const mesh = collide::upload(space, collide::triangle_soup(triangles.data(), triangles.size() / 9));
  auto const mine = collide::upload(space, collide::spheres_xyz(centres.data(), centres.size() / 3, radius));

  collide::distributed<collide::detector<collide::bucket, collide::karabassi<>, Space>, Ranks> detector(ranks, space);
  detector.build(mesh.view(), collide::divided);
  auto const found = detector.query(mine.view(), collide::pairs(collide::order::canonical));

  std::uint64_t sum = 0, sum_of_all = 0;
  for (auto [sphere, triangle] : found.to_host()) sum += mixed(first + sphere, triangle);
  ranks.reduce(&sum, &sum_of_all, 1, collide::reduction::sum);
  auto const total = detector.total(found);
  if (rank == 0) {
    std::printf("%d rank(s): %llu pairs, fingerprint %016llx\n", size, static_cast<unsigned long long>(total),
                static_cast<unsigned long long>(sum_of_all));
  }
}

/// A rank takes a GPU, if there are any, else a core of the host.
template <class Ranks>
void start(Ranks const& ranks) {
#if defined(__CUDACC__)
  if (int const devices = collide::cuda_device_count(); devices > 0) {
    collide::cuda_check(cudaSetDevice(ranks.rank() % devices), "cudaSetDevice");
    return work(ranks, collide::cuda_shared());
  }
#endif
  work(ranks, collide::host(1));
}

}  // namespace

int main(int argc, char** argv) try {
  std::string const how = argc > 1 ? argv[1] : "3";
  if (how != "mpi") {
    collide::thread_ranks::run(std::atoi(how.c_str()), [](auto const& ranks) { start(ranks); });
    return 0;
  }
#if defined(COLLIDE_HAS_MPI)
  collide::mpi_session const session(argc, argv);
  start(collide::mpi_ranks());
  return 0;
#else
  std::fprintf(stderr, "compiled without MPI\n");
  return 1;
#endif
} catch (std::exception const& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
