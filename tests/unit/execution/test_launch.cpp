/// How many blocks a kernel is launched with.
#include <cstddef>

#include <doctest/doctest.h>

#include <collide/detail/execution/launch.hpp>

namespace {

struct kernel {
  static constexpr int items = 3;
};

struct space {
  template <class Kernel>
  struct block {
    static constexpr int num_threads = 32, items = Kernel::items;
  };
  std::size_t saturating, resident;

  std::size_t saturating_blocks() const { return saturating; }
  template <class Kernel>
  std::size_t max_resident_blocks() const {
    return resident;
  }
};

}  // namespace

TEST_CASE("launch: blocks cover all items, and no block has none") {
  for (std::size_t n = 0; n < 1000; ++n) {
    std::size_t const blocks = collide::detail::grid_size<space>(n, kernel{});
    CHECK(blocks * 96 >= n);
    CHECK((blocks == 0 || (blocks - 1) * 96 < n));
  }
}

TEST_CASE("launch: no more blocks than are resident, nor than saturate the space") {
  CHECK(collide::detail::resident_blocks<kernel>(space{7, 12}) == 7);
  CHECK(collide::detail::resident_blocks<kernel>(space{12, 7}) == 7);
}
