// expect: collide: ranks have a const member reduce(mine, all, n, reduction)
#include <collide/bucket.cuh>
#include <collide/ranks/distributed.hpp>

struct no_ranks {
  int rank() const { return 0; }
  int size() const { return 1; }
  void all_gather(void const*, std::size_t, void*) const {}
};

int main() { collide::distributed<collide::detector<collide::bucket>, no_ranks> parts; }
