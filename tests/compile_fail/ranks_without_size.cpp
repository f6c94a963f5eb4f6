// expect: collide: ranks have const members rank() and size(), such as one_rank, thread_ranks and mpi_ranks
#include <collide/bucket.cuh>
#include <collide/ranks/distributed.hpp>

struct no_ranks {
  int rank() const { return 0; }
};

int main() { collide::distributed<collide::detector<collide::bucket>, no_ranks> parts; }
