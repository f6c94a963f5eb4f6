/// \file
/// A coarse grid over the triangles of all ranks, as each rank has it: which cells a box meets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/core/moving_spheres.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/ranks/ranks.hpp>

namespace collide::detail {

/// A box around a sphere at all times of the step, with room for the rounding of any narrow phase at triangles of up to
/// `extent`; empty if the sphere can touch nothing.
template <class S>
COLLIDE_HD aabb<double> reach_of(sphere<S> const& s, vec3<S> const& displacement, double extent) {
  auto box = aabb<double>::empty();
  if (!is_valid_radius(s.radius) || !is_finite(s.centre) || !is_finite(displacement)) return box;
  constexpr S tiny = std::numeric_limits<S>::min();
  double const unit = static_cast<double>(ieee_traits<float>::unit_roundoff), r = static_cast<double>(s.radius);
  for (int k = 0; k < 3; ++k) {
    double const from = static_cast<double>(s.centre[k]), along = static_cast<double>(displacement[k]);
    double const size = (from < 0 ? -from : from) + (along < 0 ? -along : along);
    double const most = r * (1 + 16 * unit) + 16 * unit * (extent + (along < 0 ? -along : along)) + 0x1p-48 * size +
                        2 * sqrt_rn(static_cast<double>(tiny));
    box.lower[k] = min(from, from + along) - most;
    box.upper[k] = max(from, from + along) + most;
  }
  return box;
}

/// A cube of cells, in levels of 1, 8, 64, ... cells, each of which halves the width of the one before.
class coarse_grid {
 public:
  static constexpr int finest = 5;
  static constexpr int cells_across = 1 << finest;

  /// Number of the first cell of a level, and with level finest + 1 of all cells.
  static COLLIDE_HD constexpr std::size_t first_of(int level) { return ((std::size_t{1} << (3 * level)) - 1) / 7; }
  static constexpr std::size_t size() { return first_of(finest + 1); }

  /// Over the boxes of all ranks: all call it, each with the box of its own triangles.
  template <class Ranks>
  void build(Ranks const& ranks, aabb<double> const& mine) {
    std::uint64_t bits[6], largest[6];
    for (int k = 0; k < 3; ++k) {
      bits[k] = to_ordered_bits(-mine.lower[k]);
      bits[3 + k] = to_ordered_bits(mine.upper[k]);
    }
    ranks.reduce(bits, largest, 6, reduction::max);
    for (int k = 0; k < 3; ++k) {
      frame_.lower[k] = -from_ordered_bits<double>(largest[k]);
      frame_.upper[k] = from_ordered_bits<double>(largest[3 + k]);
      double const half = frame_.upper[k] / 2 - frame_.lower[k] / 2, scale = half > 0 ? cells_across / half : 0;
      scale_[k] = is_finite(scale) ? scale : 0;
    }
  }

  COLLIDE_HD aabb<double> const& frame() const { return frame_; }

  /// How many cells of a level one unit is on an axis; 0 if all is in the first.
  double cells_on(int axis, int level) const { return scale_[axis] / (2 << (finest - level)); }

  /// True if the box reaches into the frame.
  COLLIDE_HD bool meets(aabb<double> const& box) const {
    bool so = !frame_.is_empty() && !box.is_empty();
    for (int k = 0; k < 3; ++k) so = so && box.lower[k] <= frame_.upper[k] && frame_.lower[k] <= box.upper[k];
    return so;
  }

  /// Calls f(cell) for up to 8 cells that cover what the box has of the frame: those of the finest level of which it
  /// meets two along an axis. Two boxes that share a point have cells of which one is, or is part of, the other.
  template <class F>
  COLLIDE_HD void for_each_cell(aabb<double> const& box, F const& f) const {
    int low[3], high[3], level = finest;
    for (int k = 0; k < 3; ++k) {
      low[k] = cell(k, box.lower[k]);
      high[k] = cell(k, box.upper[k]);
    }
    while (high[0] - low[0] > 1 || high[1] - low[1] > 1 || high[2] - low[2] > 1) {
      --level;
      for (int k = 0; k < 3; ++k) {
        low[k] >>= 1;
        high[k] >>= 1;
      }
    }
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int x = low[0]; x <= high[0]; ++x) f(first_of(level) + place_of(x, y, z));
      }
    }
  }

  /// Place on a curve through all cells of the finest level, on which those near each other are mostly near, of the
  /// cell at the box's centre. It is below `places`.
  std::size_t place_at(aabb<double> const& box) const {
    if (box.is_empty()) return 0;
    int at[3];
    for (int k = 0; k < 3; ++k) at[k] = cell(k, box.lower[k] / 2 + box.upper[k] / 2);
    return place_of(at[0], at[1], at[2]);
  }
  static constexpr std::size_t places = std::size_t{1} << (3 * finest);

  /// Number of a cell of a level.
  static std::size_t cell_at(int level, int x, int y, int z) { return first_of(level) + place_of(x, y, z); }

  /// Number of the cell that contains a cell, which is not the first of all.
  static constexpr std::size_t parent_of(std::size_t cell) { return (cell - 1) / 8; }

 private:
  /// Rises with x.
  COLLIDE_HD int cell(int axis, double x) const {
    double const inside = min(max(x, frame_.lower[axis]), frame_.upper[axis]);
    double const at = (inside / 2 - frame_.lower[axis] / 2) * scale_[axis];
    return at < cells_across - 1 ? static_cast<int>(at) : cells_across - 1;
  }

  /// Bits of the coordinates in turn: the eight cells of one cell follow each other.
  static COLLIDE_HD std::size_t place_of(int x, int y, int z) { return spread(x) | spread(y) << 1 | spread(z) << 2; }

  /// The bits of a coordinate, each followed by two zeros.
  static COLLIDE_HD std::size_t spread(int x) {
    static_assert(finest <= 8, "collide: a coordinate has eight bits at most");
    auto bits = static_cast<std::uint32_t>(x);
    bits = (bits | bits << 8) & 0x00f00fu;
    bits = (bits | bits << 4) & 0x0c30c3u;
    return (bits | bits << 2) & 0x249249u;
  }

  aabb<double> frame_ = aabb<double>::empty();
  double scale_[3] = {};  ///< cells in half a unit
};

}  // namespace collide::detail
