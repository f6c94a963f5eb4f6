/// How many grids and cells a memory budget allows.
#include <algorithm>
#include <cstddef>
#include <memory_resource>
#include <vector>

#include <doctest/doctest.h>

#include <collide/bucket.cuh>

#include "execution/lockstep.hpp"
#include "io/counting.hpp"
#include "random_triangles.hpp"

using collide::detail::memory_plan;
using collide::detail::table_size;

namespace {

/// The bytes of a plan's tables and entries.
std::size_t bytes_of(memory_plan const& plan) {
  if (plan.grids == 0) return 0;
  return table_size(static_cast<std::size_t>(plan.grids) << plan.table_bits) * sizeof(collide::detail::item_range) +
         plan.entries * sizeof(collide::detail::cell_item);
}

}  // namespace

TEST_CASE("memory plan: within the budget, and no fewer grids or cells with a larger one") {
  for (std::size_t triangles : {std::size_t{1}, std::size_t{1000}, std::size_t{1000000}}) {
    for (std::size_t spheres : {std::size_t{0}, std::size_t{100000}, std::size_t{100000000}}) {
      for (bool is_width_given : {false, true}) {
        memory_plan before;
        for (std::size_t budget = 64; budget < (std::size_t{1} << 36); budget *= 2) {
          std::size_t const fixed = 40;
          auto const plan = memory_plan::make(triangles, spheres, 4, is_width_given, fixed, budget);
          CHECK(plan.grids <= 4);
          if (plan.grids != 0) {
            CHECK(fixed + bytes_of(plan) <= budget);
            CHECK(plan.entries >=
                  8 * triangles * static_cast<std::size_t>(plan.grids));  // a small triangle is in 8 cells
          }
          CHECK(plan.grids >= before.grids);
          if (plan.grids == before.grids) CHECK(plan.table_bits >= before.table_bits);
          before = plan;
        }
        auto const free = memory_plan::make(triangles, spheres, 4, is_width_given, 40, 0);
        CHECK(free.grids == 4);
        CHECK(free.table_bits >= before.table_bits);
      }
    }
  }
}

TEST_CASE("memory plan: too little memory, or too many triangles for numbers of 32 bits, is no grid") {
  CHECK(memory_plan::make(1000, 0, 4, false, 0, 1000).grids == 0);
  CHECK(memory_plan::make(1000, 0, 4, false, 1 << 20, 1 << 20).grids == 0);
  CHECK(memory_plan::make(536870911, 0, 1, false, 0, 0).grids == 1);
  CHECK(memory_plan::make(536870912, 0, 1, false, 0, 0).grids == 0);
}

TEST_CASE("memory plan: what a device holds besides the mesh, the spheres and the pairs") {
  struct numbers {
    std::size_t triangles, spheres, entries, cells, undecided;
  };
  for (numbers const n : {numbers{2000, 200000, 16 * 2000 + 50000 + 4096, 1 << 14, 1024 + (1 << 17) + 3125},
                          numbers{5000, 3000, 48 * 5000 + 750 + 4096, 1 << 15, 1024 + 3000 + 46},
                          numbers{1008, 1000, 12 * 1008 + 250 + 512, 1 << 12, 1024 + 1000 + 15}}) {
    auto const corners =
        tests::random_triangles<float>(n.triangles, {9, 5, 1}, [](std::size_t, auto const&) { return 1; });
    std::vector<float> centres;
    for (std::size_t i = 0; i < 3 * n.spheres; ++i) centres.push_back(corners[i % corners.size()]);
    io::counting_resource memory(std::pmr::new_delete_resource());
    using space = tests::lockstep<64, false>;
    collide::detector<collide::bucket, collide::karabassi<>, space> detector(space(1, &memory));
    collide::any_hit touched;
    auto const run = [&] {
      detector.build(collide::triangle_soup(corners.data(), n.triangles));
      for (int k = 0; k < 4; ++k) {
        detector.query(collide::spheres_xyz(static_cast<float const*>(centres.data()), n.spheres, 0.01f), touched);
      }
    };
    run();
    CAPTURE(n.triangles);
    // no boxes; flags
    std::size_t const bytes = 8 * (n.entries + table_size(n.cells) + n.undecided) + n.spheres;
    CHECK(memory.in_use <= bytes + 30000);
    CHECK(memory.in_use >= bytes);
    auto const before = memory.allocations;
    run();
    CHECK(memory.allocations == before);
  }
}

TEST_CASE("memory plan: few spheres do not pay for a cell of each of many triangles, but many steps do") {
  CHECK(memory_plan::make(10000000, 1 << 20, 1, false, 0, 0).table_bits == 20);
  CHECK(memory_plan::make(10000000, 1, 1, false, 0, 0).table_bits == 18);
  CHECK(memory_plan::make(10000000, 1, 1, false, 0, 0, true).table_bits == 24);
  CHECK(memory_plan::make(2000000, 2000000, 1, false, 0, 0).table_bits == 21);
}
