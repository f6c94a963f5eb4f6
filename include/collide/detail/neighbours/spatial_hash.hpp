/// \file
/// The cells of a grid in a table of fixed size, whatever the size of the scene.
#pragma once

#include <cstdint>

#include <collide/detail/numeric/rounding.hpp>

namespace collide::detail {

/// The cells of a table.
template <class S>
struct spatial_hash {
  S inverse_width;
  std::uint32_t mask;  ///< number of blocks - 1

  static constexpr std::uint32_t cells_per_brick = 64;
  static constexpr std::uint32_t stride = cells_per_brick + 1;  ///< of blocks in the table: see `sorted_particles`

  struct cell {
    std::int32_t x, y, z;
  };

  COLLIDE_HD_INLINE cell of(S x, S y, S z) const { return {coordinate(x), coordinate(y), coordinate(z)}; }

  /// Place of a cell in the table.
  COLLIDE_HD_INLINE std::uint32_t number(cell c) const {
    auto const u = [](std::int32_t v) { return static_cast<std::uint32_t>(v); };
    std::uint32_t const block = u(c.x >> 4) * 73856093u ^ u(c.y >> 1) * 19349663u ^ u(c.z >> 1) * 83492791u;
    std::uint32_t const mixed = (block ^ block >> 15) * 0x2c1b3c6du;
    return ((mixed ^ mixed >> 13) & mask) * stride + ((u(c.z) & 1) << 5 | (u(c.y) & 1) << 4 | (u(c.x) & 15));
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

}  // namespace collide::detail
