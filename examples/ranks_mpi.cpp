/// \file
/// Ranks that are processes of MPI, as `mpirun -np 3 build/examples/ranks_mpi` starts them: each has the whole mesh and
/// a part of the spheres.

#include <cstdio>
#include <exception>

#include <collide/bucket.cuh>
#include <collide/ranks/distributed.hpp>
#include <collide/ranks/mpi.hpp>

int main(int argc, char** argv) try {
  collide::mpi_session const session(argc, argv);
  collide::mpi_ranks const ranks;

  float const floor[] = {0, 0, 0, 100, 0, 0, 0, 100, 0};
  float const centre[] = {10, 10, static_cast<float>(ranks.rank())};  // one sphere, in the height of the rank's number

  collide::distributed<collide::detector<collide::bucket>, collide::mpi_ranks> detector(ranks);
  detector.build(collide::triangle_soup(floor, 1), collide::on_every_rank);
  auto const found = detector.query(collide::spheres_xyz(centre, 1, 1.5f), collide::pairs());
  auto const total = detector.total(found);
  if (ranks.rank() == 0) std::printf("%u pairs\n", static_cast<unsigned>(total));
} catch (std::exception const& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
