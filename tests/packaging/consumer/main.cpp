#include <cstdio>
#include <cstring>

#include "hits.hpp"

std::uint64_t hits_of_the_other_unit();

/// Whether the host has as many threads as it must, and says what is missing where it has but one.
bool has_threads(bool several) {
  try {
    return collide::host(2).threads() == 2 && several;
  } catch (collide::error const& e) {
    std::puts(e.what());
    return std::strstr(e.what(), "-fopenmp") != nullptr && collide::host(1).threads() == 1 && !several;
  }
}

#if defined(__CUDACC__)
/// Whether a detector without its device is refused when it is made.
bool refuses_without_device() {
  try {
    collide::detector<collide::bucket, collide::karabassi<>, space> detector;
    return false;
  } catch (collide::cuda_error const&) {
    return true;
  }
}
#endif

/// The argument is `one` or `several`: the threads that the host must have.
int main(int argc, char** argv) {
  if (argc != 2 || !has_threads(std::strcmp(argv[1], "several") == 0)) return 2;
#if defined(__CUDACC__)
  if (collide::cuda_device_count() == 0) return refuses_without_device() ? 77 : 3;  // 77: the rest is skipped
#endif
  return hits() == 1 && hits_of_the_other_unit() == 1 ? 0 : 1;
}
