// expect: collide: ranks have a const member all_gather(mine, bytes, all)
#include <collide/bucket.cuh>
#include <collide/ranks/distributed.hpp>

struct no_ranks {
  int rank() const { return 0; }
  int size() const { return 1; }
};

int main() { collide::distributed<collide::detector<collide::bucket>, no_ranks> parts; }
