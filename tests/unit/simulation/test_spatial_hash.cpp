/// The cells of particles in a table.
#include <limits>
#include <set>

#include <doctest/doctest.h>

#include <collide/simulation/detail/neighbours/spatial_hash.hpp>

TEST_CASE_TEMPLATE("spatial hash: coordinates are rounded down, and what is too far away is somewhere", S, float,
                   double) {
  collide::detail::spatial_hash<S> const cells{S(2), 63};
  auto const c = cells.of(S(0.75), S(-0.25), S(-3));
  CHECK((c.x == 1 && c.y == -1 && c.z == -6));
  CHECK(cells.of(std::numeric_limits<S>::max(), -std::numeric_limits<S>::infinity(), 0).x == 1 << 30);
  CHECK(cells.of(std::numeric_limits<S>::max(), -std::numeric_limits<S>::infinity(), 0).y == -(1 << 30));
}

TEST_CASE("spatial hash: cells of a block have places of their own, one after the other along x") {
  using table = collide::detail::spatial_hash<float>;
  table const cells{1, 63};
  for (std::int32_t block = -4; block < 4; ++block) {
    std::set<std::uint32_t> places;
    for (std::int32_t z = 0; z < 2; ++z) {
      for (std::int32_t y = 0; y < 2; ++y) {
        std::uint32_t const row = cells.number({16 * block, y, z});
        for (std::int32_t x = 0; x < 16; ++x) {
          std::uint32_t const place = cells.number({16 * block + x, y, z});
          CHECK(place == row + static_cast<std::uint32_t>(x));
          CHECK(place / table::stride == row / table::stride);
          CHECK(place < 64 * table::stride);
          places.insert(place);
        }
      }
    }
    CHECK(places.size() == table::cells_per_block);
  }
}

TEST_CASE("spatial hash: blocks of a cube are together") {
  using table = collide::detail::spatial_hash<float>;
  table const cells{1, 4095};
  for (std::int32_t x = -2; x < 2; ++x) {
    std::set<std::uint32_t> blocks, cubes;
    for (std::int32_t z = -16; z < 0; ++z) {
      for (std::int32_t y = 16; y < 32; ++y) {
        std::uint32_t const block = cells.number({16 * x, y, z}) / table::stride;
        blocks.insert(block);
        cubes.insert(block / 64);
      }
    }
    CHECK(blocks.size() == 64);
    CHECK(cubes.size() == 1);
  }
}
