#define DOCTEST_CONFIG_IMPLEMENT
#include <cstdio>
#include <cstring>

#include <doctest/doctest.h>

#if defined(COLLIDE_TESTS_CUDA)
int cuda_devices();  // of test_api_cuda.cpp
#endif

/// Without a device the tests of the CUDA spaces end in 77, which CTest shows as skipped.
int main(int argc, char** argv) {
#if defined(COLLIDE_TESTS_CUDA)
  bool listing = false;
  for (int i = 1; i < argc; ++i) listing = listing || std::strncmp(argv[i], "--list", 6) == 0;
  if (!listing && cuda_devices() == 0) {
    std::puts("skipped: no CUDA device");
    return 77;
  }
#endif
  return doctest::Context(argc, argv).run();
}
