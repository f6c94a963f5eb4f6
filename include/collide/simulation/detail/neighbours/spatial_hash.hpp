/// \file
/// The cells of a grid in a table of fixed size, whatever the size of the scene.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/exact/detail/numeric/rounding.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

/// The cells of a table.
template <class S>
struct spatial_hash {
  S inverse_width;
  std::uint32_t mask;  ///< number of blocks - 1

  static constexpr std::uint32_t cells_per_block = 64;
  static constexpr std::uint32_t stride = cells_per_block + 1;  ///< of blocks in the table: see `sorted_particles`

  /// How many blocks of cells there are for `n` particles or spheres.
  static std::size_t blocks_for(std::size_t n) {
    std::uint32_t bits = 0;
    while (bits < 22 && (std::size_t{cells_per_block} << bits) < 2 * n) ++bits;
    return std::size_t{1} << bits;
  }

  struct cell {
    std::int32_t x, y, z;
  };

  COLLIDE_HD_INLINE cell of(S x, S y, S z) const { return {coordinate(x), coordinate(y), coordinate(z)}; }

  /// Place of a cell in the table. Blocks of 16 x 16 x 16 cells are together, along a curve: so most neighbours of a
  /// particle are near it in memory.
  COLLIDE_HD_INLINE std::uint32_t number(cell c) const {
    auto const u = [](std::int32_t v) { return static_cast<std::uint32_t>(v); };
    auto const apart = [](std::uint32_t v) { return (v & 2) >> 1 | (v & 4) | (v & 8) << 1; };
    std::uint32_t const cube = u(c.x >> 4) * 73856093u ^ u(c.y >> 4) * 19349663u ^ u(c.z >> 4) * 83492791u;
    std::uint32_t const mixed = (cube ^ cube >> 15) * 0x2c1b3c6du, spread = mixed ^ mixed >> 13;
    std::uint32_t const block = (spread << 6 | spread >> 26) ^ apart(u(c.y)) ^ apart(u(c.z)) << 1;
    return (block & mask) * stride + ((u(c.z) & 1) << 5 | (u(c.y) & 1) << 4 | (u(c.x) & 15));
  }

  /// The place of the block of a cell along a curve, on which near blocks are near: G. M. Morton, "A computer oriented
  /// geodetic data base", 1966.
  static COLLIDE_HD_INLINE std::uint32_t on_curve(cell c) {
    std::uint32_t along = 0;
    for (std::uint32_t k = 0; k < 10; ++k) {
      auto const bit = [&](std::int32_t v) { return static_cast<std::uint32_t>(v) >> k & 1; };
      along |= (bit(c.x >> 4) | bit(c.y >> 1) << 1 | bit(c.z >> 1) << 2) << 3 * k;
    }
    return along;
  }

 private:
  /// Rounded down; NaN and what is too far away are somewhere.
  COLLIDE_HD_INLINE std::int32_t coordinate(S x) const {
    constexpr S end = S(1 << 30);
    S const c = min(end, max(-end, mul_rn(x, inverse_width)));
    auto const i = static_cast<std::int32_t>(c);
    return static_cast<S>(i) > c ? i - 1 : i;
  }
};

/// Kernel functor over the blocks of a table: counts become where cells begin. The count of the cell at place c is at
/// ends[c + 1].
struct scan_cells {
  std::uint32_t* ends;
  std::uint32_t* count;  ///< of all; 0 before

  COLLIDE_HD void operator()(std::size_t b) const {
    constexpr std::uint32_t n = spatial_hash<float>::cells_per_block;
    std::uint32_t* const block = ends + b * spatial_hash<float>::stride;
    std::uint32_t counts[n], sum = 0;  // all are on their way at once
    for (std::uint32_t c = 0; c < n; ++c) counts[c] = block[c + 1];
    for (std::uint32_t c = 0; c < n; ++c) sum += counts[c];
    if (sum == 0) return;
    std::uint32_t next = fetch_add(count, sum);
    block[0] = next;
    for (std::uint32_t c = 0; c < n; ++c) {
      block[c + 1] = next;
      next += counts[c];
    }
  }
};

}  // namespace collide::detail
