/// \file
/// Which cells have triangles.
#pragma once

#include <cstdint>

#include <collide/broad/detail/grid/grid.hpp>
#include <collide/broad/detail/grid/swept_cells.hpp>
#include <collide/exact/detail/geometry/sphere_pack.hpp>

namespace collide::detail {

/// Which cells have triangles, of the one level of the one grid that serves spheres of one radius: all that most
/// spheres are asked, small enough to be kept in registers.
template <class S>
struct occupancy_view {
  S lower[3];
  uint_for<S> extent[3];  ///< as bits, which are in the order of the numbers from 0 on; all others are larger
  grid_level<S> level;
  std::uint8_t const* occupied;

  /// The cells of several centres, and whether each is inside the grid at all.
  template <unsigned N>
  struct places {
    std::uint32_t cells[N], inside[N];
  };

  /// Without branches, for the CPU's vector unit.
  template <unsigned N>
  COLLIDE_HD_INLINE places<N> places_of(S const (&x)[N], S const (&y)[N], S const (&z)[N]) const {
    places<N> p;
    for (unsigned k = 0; k < N; ++k) {
      S const dx = x[k] - lower[0], dy = y[k] - lower[1], dz = z[k] - lower[2];
      p.inside[k] = to_bits(dx) <= extent[0] ? 1u : 0u;
      p.inside[k] &= to_bits(dy) <= extent[1] ? 1u : 0u;
      p.inside[k] &= to_bits(dz) <= extent[2] ? 1u : 0u;
      std::uint32_t const cell = level.row(level.coordinate_inside(dy), level.coordinate_inside(dz)) +
                                 (level.coordinate_inside(dx) & level.mask[0]);
      p.cells[k] = p.inside[k] != 0 ? cell : level.first;  // outside there are no cells
    }
    return p;
  }

  /// Tells for each of the centres, or spheres, if there may be triangles near it. False if that is not known.
  template <unsigned N>
  COLLIDE_HD_INLINE void test_occupied(places<N> const& p, bool (&near)[N]) const {
    for (unsigned k = 0; k < N; ++k) near[k] = (p.inside[k] & occupied[p.cells[k] / 8] >> p.cells[k] % 8 & 1) != 0;
  }
  template <unsigned N>
  COLLIDE_HD_INLINE bool test_occupied(sphere_pack<S, N> const& b, bool (&near)[N]) const {
    test_occupied(places_of(b.x, b.y, b.z), near);
    return true;
  }
  template <unsigned N>
  COLLIDE_HD_INLINE bool test_occupied(moving_pack<S, N> const& b, bool (&near)[N]) const {
    return test_swept(b, near);
  }
  COLLIDE_HD_INLINE bool is_occupied(std::uint32_t cell) const { return (bit_of(cell) & 1) != 0; }

  /// Which of some moving spheres may be near a triangle: sets near[k]. Returns false if that is not known, since one
  /// of them is not finite or moves through many cells.
  template <unsigned N>
  COLLIDE_HD_INLINE bool test_swept(moving_pack<S, N> const& b, bool (&near)[N]) const {
    bool known = true;
    std::uint32_t first[N], apart[N][3];  // the first cell, and how far from it the second on each axis is
    for (unsigned k = 0; k < N; ++k) {
      cells_on_axis const on[3] = {cells_on(0, b.x[k], b.dx[k]), cells_on(1, b.y[k], b.dy[k]),
                                   cells_on(2, b.z[k], b.dz[k])};
      bool const inside = (on[0].inside & on[1].inside & on[2].inside) != 0;
      bool const is_short = on[0].more <= 1 && on[1].more <= 1 && on[2].more <= 1;
      // what is not finite is not in the cells that it seems to be in
      known = known && is_finite(on[0].extent + (on[1].extent + on[2].extent)) && (is_short || !inside);
      near[k] = inside;
      first[k] = level.first + (inside ? on[0].begin + (on[1].begin + on[2].begin) : 0);
      for (int axis = 0; axis < 3; ++axis) apart[k][axis] = inside ? on[axis].end - on[axis].begin : 0;
    }
    if (!known) return false;
    for (unsigned k = 0; k < N; ++k) {
      std::uint32_t const several =
          (apart[k][0] != 0 ? 1u : 0u) | (apart[k][1] != 0 ? 2u : 0u) | (apart[k][2] != 0 ? 4u : 0u);
      std::uint32_t found = bit_of(first[k]);
      for (std::uint32_t some = several; some != 0; some = (some - 1) & several) {  // the second on some of the axes
        found |= bit_of(first[k] + ((some & 1) != 0 ? apart[k][0] : 0) + ((some & 2) != 0 ? apart[k][1] : 0) +
                        ((some & 4) != 0 ? apart[k][2] : 0));
      }
      near[k] = near[k] && (found & 1) != 0;
    }
    return true;
  }

 private:
  /// The cells of a path on an axis, as `swept_cells` has them.
  struct cells_on_axis {
    std::uint32_t inside, begin, end;  ///< cells: what they add to the number of a cell
    std::uint32_t more;                ///< cells than one
    S extent;
  };

  COLLIDE_HD_INLINE cells_on_axis cells_on(int axis, S from, S along) const {
    S const to = from + along, slack = swept_cells<S>::rounding_slack(from, along),
            highest = from_bits<S>(extent[axis]);
    S const first = min(from, to) - slack - lower[axis], last = max(from, to) + slack - lower[axis];
    std::uint32_t const begin = level.coordinate_inside(min(first, highest)),
                        end = level.coordinate_inside(min(last, highest));
    std::uint32_t const stride = axis == 0 ? 1 : level.stride[axis - 1];
    return {(first <= highest ? 1u : 0u) & (last >= 0 ? 1u : 0u), (begin & level.mask[axis]) * stride,
            (end & level.mask[axis]) * stride, end - begin, last - first};
  }

  /// In the lowest bit, whether the cell has triangles.
  COLLIDE_HD_INLINE std::uint32_t bit_of(std::uint32_t cell) const {
    return static_cast<std::uint32_t>(occupied[cell / 8]) >> cell % 8;
  }
};

}  // namespace collide::detail
