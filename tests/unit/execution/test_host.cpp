/// How many threads the host takes.
#include <array>
#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <thread>

#include <doctest/doctest.h>

#include <collide/host.hpp>
#include <collide/spaces/detail/algorithms.hpp>

#if defined(_OPENMP)

namespace {

constexpr std::size_t blocks = 16;

/// The most threads that a loop runs on, each block of which takes `each`.
int threads_of(collide::host const& space, std::chrono::microseconds each) {
  std::array<int, blocks> seen{};
  collide::detail::for_each_block(space, blocks, [&](std::size_t i) {
    seen[i] = omp_get_num_threads();
    if (each.count() != 0) std::this_thread::sleep_for(each);
  });
  int most = 0;
  for (int const threads : seen) {
    CHECK(threads >= 1);  // each block has run
    most = threads > most ? threads : most;
  }
  return most;
}

/// Calls f on a thread that has begun no loop yet, and so has no threads to help it, but is offered 64.
template <class F>
void on_new_thread(F const& f) {
  std::thread([&] {
    omp_set_num_threads(64);
    f();
  }).join();
}

}  // namespace

TEST_CASE("host: where threads came too late the next loops run on one, and later on all again") {
  using std::chrono::microseconds;
  int first = 0, second = 0, later = 0;
  on_new_thread([&] {
    collide::host const space;
    first = threads_of(space, microseconds(0));  // to make the threads takes longer than the work
    second = threads_of(space, microseconds(0));
    for (int tries = 0; tries < 10000 && later < 2; ++tries) later = threads_of(space, microseconds(500));
  });
  CHECK(first > 1);
  CHECK(second == 1);
  CHECK(later > 1);
}

TEST_CASE("host: a number of threads that is given is taken, however little there is to do") {
  on_new_thread([] {
    for (int k = 0; k < 20; ++k) {
      CHECK(threads_of(collide::host(2), std::chrono::microseconds(0)) == 2);
      CHECK(threads_of(collide::host(1), std::chrono::microseconds(0)) == 1);
    }
  });
}

TEST_CASE("host: what a block throws comes out of the loop, also where one thread works alone") {
  on_new_thread([] {
    collide::host const space;
    for (int k = 0; k < 3; ++k) {
      CHECK_THROWS_AS(collide::detail::for_each_block(space, blocks,
                                                      [](std::size_t i) {
                                                        if (i == 7) throw std::runtime_error("seven");
                                                      }),
                      std::runtime_error);
    }
    CHECK(threads_of(space, std::chrono::microseconds(0)) >= 1);
  });
}

#endif
