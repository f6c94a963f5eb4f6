#include <cstdio>
#include <cstring>

#include "hits.hpp"

std::uint64_t hits_of_the_other_unit();

#if defined(FOUND_VERSION)
#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)
/// The version by find_package, and by the header.
constexpr char const found_version[] = TEXT(FOUND_VERSION);
constexpr char const header_version[] =
    TEXT(COLLIDE_VERSION_MAJOR) "." TEXT(COLLIDE_VERSION_MINOR) "." TEXT(COLLIDE_VERSION_PATCH);
#else
constexpr char const found_version[] = "", header_version[] = "";
#endif

/// True if the host has as many threads as it must; prints the reason where it has but one.
bool has_threads(bool several) {
  try {
    return collide::host(2).threads() == 2 && several;
  } catch (collide::error const& e) {
    std::puts(e.what());
    return std::strstr(e.what(), "-fopenmp") != nullptr && collide::host(1).threads() == 1 && !several;
  }
}

#if defined(__CUDACC__)
/// True if a detector without its device is refused when it is made.
bool refuses_without_device() {
  try {
    collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
    return false;
  } catch (collide::cuda_error const&) {
    return true;
  }
}
#endif

static_assert(COLLIDE_VERSION >= 100 && COLLIDE_VERSION / 10000 == COLLIDE_VERSION_MAJOR);

/// The argument is `one` or `several`: the threads that the host must have.
int main(int argc, char** argv) {
  if (argc != 2 || !has_threads(std::strcmp(argv[1], "several") == 0)) return 2;
  if (std::strcmp(found_version, header_version) != 0) return 4;
#if defined(__CUDACC__)
  if (collide::cuda_device_count() == 0) return refuses_without_device() ? 77 : 3;  // 77: the rest is skipped
#endif
  return hits() == 1 && hits_of_the_other_unit() == 1 ? 0 : 1;
}
