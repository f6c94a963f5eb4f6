#include "hits.hpp"

std::uint64_t hits_of_the_other_unit();

int main() {
#if defined(__CUDACC__)
  if (collide::cuda_device_count() == 0) return 77;  // skipped
#endif
  return hits() == 1 && hits_of_the_other_unit() == 1 ? 0 : 1;
}
