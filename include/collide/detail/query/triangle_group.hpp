/// \file
/// Triangles that follow each other in a mesh, and mostly on its surface: a sphere that is not near all of them need
/// not be compared with each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/detail/geometry/aabb.hpp>
#include <collide/detail/grid/triangle_cells.hpp>

// the numbers of elements of small arrays are int
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion"

namespace collide::detail {

/// The boxes of eight triangles, number by number in arrays of their own, and the box around all of them.
template <class S>
struct triangle_group {
  static constexpr std::uint32_t size = 8;

  S lower[3][size], upper[3][size], padding[size];
  triangle_aabb<S> all;

  /// Takes the boxes of triangles `first` and the next ones. False if one of them is not finite.
  bool load(triangle_aabb<S> const* boxes, std::size_t first) {
    all = boxes[first];
    bool finite = true;
    for (std::uint32_t i = 0; i < size; ++i) {
      triangle_aabb<S> const& b = boxes[first + i];
      finite = finite && !b.is_empty();
      for (int k = 0; k < 3; ++k) {
        lower[k][i] = b.lower[k];
        upper[k][i] = b.upper[k];
        all.lower[k] = smaller(all.lower[k], b.lower[k]);
        all.upper[k] = larger(all.upper[k], b.upper[k]);
      }
      padding[i] = b.padding;
      all.padding = larger(all.padding, b.padding);
    }
    return finite;
  }

  /// Bit i is whether a sphere can reach what is in box i: as `sphere_soa::reaching` has it. Without branches, for the
  /// processor's vector unit.
  std::uint32_t reached_by(S x, S y, S z, S reach) const {
    constexpr uint_for<S> bit[size] = {1, 2, 4, 8, 16, 32, 64, 128};  // SSE cannot shift lanes by different amounts
    uint_for<S> mask = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      S const gx = outside(0, i, x), gy = outside(1, i, y), gz = outside(2, i, z), most = reach + padding[i];
      mask |= gx * gx + (gy * gy + gz * gz) <= most * most ? bit[i] : uint_for<S>(0);
    }
    return static_cast<std::uint32_t>(mask);
  }

  /// True if all of the triangles are inside the sphere, whatever is rounded. May be false all the same.
  bool is_inside(sphere<S> const& shape) const {
    S sum = 0;
    for (int k = 0; k < 3; ++k) {
      S const far = larger(shape.centre[k] - all.lower[k], all.upper[k] - shape.centre[k]);
      sum += far * far;
    }
    constexpr S u = ieee_traits<S>::unit_roundoff;
    S const square = shape.radius * shape.radius;
    return sum <= square * (1 - 32 * u) && square > std::numeric_limits<S>::min() / (u * u) &&
           square < std::numeric_limits<S>::max() / 4;
  }

  /// True if spheres in cells of a grid had better be compared with the box around all of the triangles first: there
  /// must be few cells that it meets, and of the spheres in them few that come near it.
  bool pays(grid<S> const& g) const {
    if (g.levels != 1) return false;
    S looked_at = 1, near_all = 1;
    for (int k = 0; k < 3; ++k) {
      S const near = all.upper[k] - all.lower[k] + 2 * g.dilation;
      looked_at *= near + g.width;
      near_all *= near;
      if (!(near <= 6 * g.width)) return false;
    }
    S each = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      S one = 1;
      for (int k = 0; k < 3; ++k) one *= upper[k][i] - lower[k][i] + 2 * g.dilation + g.width;
      each += one;
    }
    return looked_at + 8 * near_all <= each;
  }

  /// True if the box around all of the triangles is small against the cells of a grid, and so meets hardly more of them
  /// than the triangles do.
  bool is_small(grid<S> const& g) const { return g.levels == 1 && 4 * all.max_extent() <= g.width; }

  /// Calls f(number, n) for the runs of cells that its dilated box meets: no cell twice.
  template <class F>
  void each_range(grid<S> const& g, F const& f) const {
    each_range_of_box(g.level[0], triangle_cells<S>(g, g.level[0], all).range(), f);
  }

 private:
  S outside(int k, std::uint32_t i, S x) const {
    S const distance = larger(lower[k][i] - x, x - upper[k][i]);
    return select(distance > 0, distance, S(0));
  }
};

}  // namespace collide::detail

#pragma GCC diagnostic pop
