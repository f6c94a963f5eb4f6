/// \file
/// Ranks that are threads: each has a part of the mesh and a part of the spheres. The same code runs on the processes
/// of MPI, see ranks_mpi.cpp.

#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/ranks/distributed.hpp>
#include <collide/ranks/thread_ranks.hpp>

/// The program of a rank: it has some triangles of a floor, and one sphere above the floor of another rank.
template <class Ranks>
void work(Ranks const& ranks) {
  auto const place = static_cast<float>(ranks.rank());
  float const triangles[] = {place,     0, 0, place + 1, 0, 0, place, 1, 0,  //
                             place + 1, 0, 0, place + 1, 1, 0, place, 1, 0};
  float const centre[] = {static_cast<float>(ranks.size()) - place - 0.5f, 0.6f, 0.25f};

  collide::distributed<collide::detector<collide::bucket>, Ranks> detector(ranks, collide::host(1));
  detector.build(collide::triangle_soup(triangles, 2), collide::divided);
  auto const found = detector.query(collide::spheres_xyz(centre, 1, 0.3f), collide::pairs(collide::order::canonical));

  auto const first = collide::count_before(ranks, 1);  // sphere 0 of this rank has this number among all
  auto const total = detector.total(found);
  for (int r = 0; r < ranks.size(); ++r) {  // one after the other
    if (r == ranks.rank()) {
      for (auto [sphere, triangle] : found.to_host()) {
        std::printf("sphere %u touches triangle %u\n", static_cast<unsigned>(first) + sphere, triangle);
      }
    }
    collide::agree(ranks);
  }
  if (ranks.rank() == 0) std::printf("%u pairs\n", static_cast<unsigned>(total));
}

int main() {
  collide::thread_ranks::run(3, [](auto const& ranks) { work(ranks); });
}
