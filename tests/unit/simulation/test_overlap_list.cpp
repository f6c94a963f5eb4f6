/// The list of the triangles that a sphere overlaps.
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include <collide/simulation/detail/walls/overlap_list.hpp>

using collide::detail::overlap_item;
using collide::detail::overlap_list;

namespace {

/// Adds so many triangles, in no order of distance, each three times.
void add_thrice(overlap_list& near, std::uint32_t triangles) {
  for (std::uint32_t k = 0; k < 3 * triangles; ++k) {
    double const distance = 1 + 0.001 * (k / 3 * 7 % 41);
    near.add({{0, 0, -distance}, distance, k / 3, 0, collide::feature::face, false, false, 0, 0, 0, 0, 0});
  }
}

}  // namespace

TEST_CASE("overlap list: triangles that are added several times are in it once") {
  overlap_list near(1e-9);
  add_thrice(near, overlap_list::capacity);
  CHECK(near.size == overlap_list::capacity);
  CHECK(!near.is_full());
}

TEST_CASE("overlap list: triangles that are added several times fit in the memory asked for") {
  constexpr std::uint32_t guard = 12345;
  overlap_list near(1e-9);
  add_thrice(near, 40);
  CHECK(near.is_full());
  std::vector<overlap_item> memory(2 * near.added);
  for (auto& item : memory) item.triangle = guard;
  near.use(memory.data());
  auto const room = near.added;
  add_thrice(near, 40);
  for (std::uint32_t i = room; i < memory.size(); ++i) CHECK(memory[i].triangle == guard);
  near.sort();
  CHECK(near.size == 40);
}
