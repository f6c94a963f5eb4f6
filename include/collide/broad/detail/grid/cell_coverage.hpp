/// \file
/// Which part of a cell a box covers, in a word: a quick test before anything else of a triangle is read.
#pragma once

#include <cstdint>

#include <collide/core/geometry.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// The part of a cell that a box covers, and what may be in it. A cell is 15 steps wide on each axis: 14 sixteenths of
/// its width, and the rest. Both are six numbers of 5 bits, two for each axis, such that a sum tells whether they meet:
/// those of a side of the box, at most 17 and 14, add up to 16 or more unless all that may be there is beyond it.
struct cell_coverage {
  static constexpr std::uint32_t first = 1, last = 15;     ///< steps
  static constexpr std::uint32_t before = 0;               ///< in place of a first step: begins in a cell before
  static constexpr std::uint32_t carry_mask = 0x21084210;  ///< 16 in all numbers
  static constexpr std::uint32_t full_box = 0x1ef7c631;    ///< a box that covers the cell, and begins before it
  static constexpr std::uint32_t full_query = 0x1ef7b9ce;  ///< what is everywhere in the cell

  /// The step at a fraction of a cell.
  template <class S>
  static COLLIDE_HD_INLINE std::uint32_t subcell_of(S fraction) {
    auto const sixteenths = static_cast<std::uint32_t>(static_cast<std::int32_t>(fraction * S(16)));
    return min(sixteenths, last - first) + first;
  }

  /// A box from the step `from` to the step `to` of an axis; to be united by `|` with the other axes.
  static COLLIDE_HD_INLINE std::uint32_t encode_box(std::uint32_t from, std::uint32_t to, int axis) {
    return (17 - from) << 5 * axis | to << (5 * axis + 15);
  }

  /// The bits from the step `from` to the step `to` of an axis; to be united with the other axes.
  static COLLIDE_HD_INLINE std::uint32_t encode_query(std::uint32_t from, std::uint32_t to, int axis) {
    return (to - 1) << 5 * axis | (16 - from) << (5 * axis + 15);
  }

  static COLLIDE_HD_INLINE bool overlaps(std::uint32_t coverage, std::uint32_t query) {
    return ((coverage + query) & carry_mask) == carry_mask;
  }

  /// An axis, to be united with others.
  static COLLIDE_HD_INLINE std::uint32_t axis(int k) { return 1u << 5 * k; }

  /// True if the box begins in a cell before on one of these axes.
  static COLLIDE_HD_INLINE bool starts_in_earlier_cell(std::uint32_t coverage, std::uint32_t axes) {
    return (coverage >> 4 & coverage & axes) != 0;  // 17, the only odd number from 16 on
  }
};

/// A cell, and a part of it or a place in it.
struct cell_ref {
  std::uint32_t number, coverage;
};

/// An entry of a cell: a triangle, and the part of the cell that its dilated box covers.
struct alignas(8) cell_item {
  id triangle;
  std::uint32_t coverage;
};

}  // namespace collide::detail
