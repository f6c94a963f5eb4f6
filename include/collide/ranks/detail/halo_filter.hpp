/// \file
/// A quick test of which spheres may be near triangles of other ranks.
#pragma once

#include <cstdint>
#include <limits>

#include <collide/exact/detail/geometry/sphere_pack.hpp>
#include <collide/ranks/detail/rank_map.hpp>

// the numbers of elements of small arrays are int
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion"

namespace collide::detail {

/// Passes every sphere that a `rank_lookup` says goes to another rank, and few more: a plain value that a kernel takes.
///
/// A box no wider than a cell meets, on each axis, the cell that it begins in and perhaps the next: the lookup has a
/// bit for these eight. Where it begins is computed in S, with room for the rounding of that and for what `reach_of`
/// adds. Proof: docs/development/numerics.md. Wider spheres pass, and where numbers may overflow all do.
template <class S>
class halo_filter {
 public:
  /// `extent`: as for `reach_of`; `radius`: of all spheres, or 0. Larger ones have larger cells.
  halo_filter(rank_lookup const& map, double extent, S radius) : rows_{map.others} {
    for (int level = coarse_grid::finest; level >= 0; --level) {
      if (!set(map, extent, level)) return;
      if (to_bits(2 * radius) < most_) return;
    }
  }

  /// Says which pass: bit k is of sphere k. Without branches, for the CPU's vector unit.
  template <int N>
  COLLIDE_HD_INLINE std::uint32_t mark(sphere_pack<S, N> const& b) const {
    static_assert(N <= 32, "collide: a word has a bit for each");
    std::uint32_t rows[N], columns[N], inside[N], wide[N];
    for (int k = 0; k < N; ++k) {
      S const r = b.radius[k], x = place(0, b.x[k], r), y = place(1, b.y[k], r), z = place(2, b.z[k], r);
      wide[k] = to_bits(2 * r) < most_ ? 0u : 1u;
      inside[k] = is_inside(x) & is_inside(y) & is_inside(z);
      bool const so = inside[k] != 0;
      columns[k] = cell(select(so, x, S(0)));
      rows[k] = cell(select(so, y, S(0))) + across_ * cell(select(so, z, S(0)));
    }
    std::uint32_t near = 0;
    for (int k = 0; k < N; ++k) near |= (wide[k] | (inside[k] & rows_[rows[k]] >> columns[k])) << k;
    return near;
  }

 private:
  /// For the cells of a level. False if numbers may overflow; all spheres pass then.
  bool set(rank_lookup const& map, double extent, int level) {
    using limits = std::numeric_limits<S>;
    auto const& frame = map.grid.frame();
    double const u = static_cast<double>(ieee_traits<S>::unit_roundoff), across = 1 << level;
    double const tiny = static_cast<double>(limits::min()), huge = static_cast<double>(limits::max());
    double most = extent;
    for (int k = 0; k < 3; ++k) {
      double const size = max(max(-frame.lower[k], frame.lower[k]), max(-frame.upper[k], frame.upper[k]));
      double const cells = map.grid.cells_on(k, level), width = cells > 0 ? 1 / cells : extent / across;
      if (!(size < huge / 8 && 1 / width < huge)) return false;
      double const room = 0x1p-12 * width + 0x1p-19 * extent + (8 * u + 0x1p-46) * size + 4 * sqrt_rn(tiny);
      lower_[k] = static_cast<S>(frame.lower[k] + room - width);
      scale_[k] = static_cast<S>(1 / width);
      most = min(most, width - 2 * room);
    }
    most_ = most > 0 ? to_bits(static_cast<S>(most)) : 0;
    end_ = to_bits(static_cast<S>(across + 1));
    across_ = 1u << level;
    rows_ = map.others + rank_lookup::first_row_of(level);
    return true;
  }

  /// The first cell of a box, in cells, one more than from the frame on.
  COLLIDE_HD_INLINE S place(int axis, S x, S radius) const { return mul_rn(x - lower_[axis] - radius, scale_[axis]); }

  /// 1 if a box that begins there may reach into the frame; on bits, which negative numbers and NaN have more of.
  COLLIDE_HD_INLINE std::uint32_t is_inside(S place) const { return to_bits(place) < end_ ? 1u : 0u; }

  /// The cell of a place; the first for one before it.
  static COLLIDE_HD_INLINE std::uint32_t cell(S place) {
    return static_cast<std::uint32_t>(max(static_cast<std::int32_t>(place) - 1, 0));
  }

  S lower_[3] = {}, scale_[3] = {};
  uint_for<S> most_ = 0;  ///< how wide a box is at most, as bits, which are in the order of the numbers from 0 on
  uint_for<S> end_ = 0;   ///< where the last cell ends, as bits
  std::uint32_t across_ = 0;
  std::uint32_t const* rows_;  ///< there are some, also where all pass
};

}  // namespace collide::detail

#pragma GCC diagnostic pop
