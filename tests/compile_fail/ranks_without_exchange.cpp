// expect: collide: ranks have a const member exchange(from, to_each, to, of_each, bytes)
#include <collide/bucket.cuh>
#include <collide/ranks/distributed.hpp>

struct no_ranks {
  int rank() const { return 0; }
  int size() const { return 1; }
  void all_gather(void const*, std::size_t, void*) const {}
  void reduce(std::uint64_t const*, std::uint64_t*, std::size_t, collide::reduction) const {}
  void exchange_counts(std::uint64_t const*, std::uint64_t*) const {}
};

int main() { collide::distributed<collide::detector<collide::bucket>, no_ranks> parts; }
