/// How many blocks a kernel is launched with.
#include <cstddef>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/karabassi.hpp>
#include <collide/simulation.cuh>
#include <collide/spaces/detail/block.hpp>

#include "execution/lockstep.hpp"

namespace {

struct kernel {
  static constexpr int items = 3;
};

struct space {
  template <class Kernel>
  struct block {
    static constexpr int num_threads = 32, items = Kernel::items;
  };
};

/// A space of threads that share blocks.
struct sharing_space {
  template <class Kernel>
  using block = tests::lockstep_block<32, 4, false>;
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

TEST_CASE("launch: a step has no more blocks than are resident, nor than saturate the space") {
  using namespace collide::detail;
  using effects = effect_list<float, collide::bounce>;
  using step = step_kernel<step_context<float, collide::karabassi<>, all_pairs_ref<float>, effects>>;
  CHECK(step::grid_size(sharing_space{7, 12}, 1 << 20) == 7);
  CHECK(step::grid_size(sharing_space{12, 7}, 1 << 20) == 7);
  CHECK(step::grid_size(sharing_space{12, 7}, 1) == 1);
}
