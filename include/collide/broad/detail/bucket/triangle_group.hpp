/// \file
/// Triangles that follow each other in a mesh, and mostly on its surface: a sphere that is not near all of them need
/// not be compared with each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/broad/detail/grid/triangle_cells.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

/// Eight triangles that follow each other in a mesh, their boxes, number by number in arrays of their own, and the box
/// around all of them.
template <class S>
struct triangle_group {
  static constexpr std::uint32_t size = 8;

  S corners[3][3][size];  ///< x, y and z of the first corner, of the second, of the third
  S lower[3][size], upper[3][size], padding[size];
  triangle_aabb<S> all;
  std::uint32_t there;  ///< bit i: there is a triangle i, and it is finite, and none that another one repeats

  static std::size_t count(std::size_t triangles) { return (triangles + size - 1) / size; }

  /// Takes triangles `first` and the next ones of a mesh, as many as there are. The boxes of what is not finite, or not
  /// there, are empty. Its loops are for the processor's vector unit.
  void load(mesh_view<S> const& mesh, std::size_t first) {
    std::size_t const n = min(mesh.size() - first, std::size_t{size});
    gather(mesh, first, n);
    uint_for<S> mask = 0;
    for (std::size_t i = 0; i < size; ++i) {
      uint_for<S> bits = 0;
      for (auto const& corner : corners) {
        for (auto const& x : corner) bits = max(bits, to_bits(x[i]) & ~ieee_traits<S>::sign_mask);
      }
      bool const finite = bits < ieee_traits<S>::exponent_mask;
      constexpr S far = std::numeric_limits<S>::max();
      S extent = 0;
      for (int k = 0; k < 3; ++k) {
        S const a = corners[0][k][i], b = corners[1][k][i], c = corners[2][k][i];
        lower[k][i] = select(finite, min(min(a, b), c), far);
        upper[k][i] = select(finite, max(max(a, b), c), -far);
        extent = max(extent, upper[k][i] - lower[k][i]);
      }
      padding[i] = triangle_aabb<S>::padding_of(extent);
      mask |= finite ? bit[i] : uint_for<S>(0);
    }
    for (std::size_t i = n; i < size; ++i) {
      for (int k = 0; k < 3; ++k) lower[k][i] = std::numeric_limits<S>::max(), upper[k][i] = -lower[k][i];
    }
    there = static_cast<std::uint32_t>(mask) & ((1u << n) - 1);
    for (int k = 0; k < 3; ++k) {
      all.lower[k] = reduced(lower[k], [](S a, S b) { return min(a, b); });
      all.upper[k] = reduced(upper[k], [](S a, S b) { return max(a, b); });
    }
    all.padding = reduced(padding, [](S a, S b) { return max(a, b); });
  }

  bool has(std::uint32_t i) const { return (there >> i & 1) != 0; }

  triangle_aabb<S> box(std::uint32_t i) const {
    return {{{lower[0][i], lower[1][i], lower[2][i]}, {upper[0][i], upper[1][i], upper[2][i]}}, padding[i]};
  }

  triangle<S> operator[](std::uint32_t i) const {
    auto const corner = [&](int c) { return vec3<S>{corners[c][0][i], corners[c][1][i], corners[c][2][i]}; };
    return {corner(0), corner(1), corner(2)};
  }

  /// Bit i is whether a sphere can reach what is in box i: as `sphere_soa::reaching` has it. Without branches, for the
  /// processor's vector unit.
  std::uint32_t reached_by(S x, S y, S z, S reach) const {
    uint_for<S> mask = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      S const gx = outside(0, i, x), gy = outside(1, i, y), gz = outside(2, i, z), reached = reach + padding[i];
      mask |= gx * gx + (gy * gy + gz * gz) <= reached * reached ? bit[i] : uint_for<S>(0);
    }
    return static_cast<std::uint32_t>(mask) & there;
  }

  /// True if all of the triangles are inside the sphere, whatever is rounded. May be false all the same.
  bool is_inside(sphere<S> const& shape) const {
    S sum = 0;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      S const far = max(shape.centre[k] - all.lower[k], all.upper[k] - shape.centre[k]);
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
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      S const near = all.upper[k] - all.lower[k] + 2 * g.dilation;
      looked_at *= near + g.width;
      near_all *= near;
      if (!(near <= 6 * g.width)) return false;
    }
    S each = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      if (!has(i)) continue;
      S one = 1;
      COLLIDE_UNROLL
      for (int k = 0; k < 3; ++k) one *= upper[k][i] - lower[k][i] + 2 * g.dilation + g.width;
      each += one;
    }
    return looked_at + 8 * near_all <= each;
  }

 private:
  static constexpr uint_for<S> bit[size] = {1,  2,  4,  8,
                                            16, 32, 64, 128};  // SSE cannot shift lanes by different amounts

  /// Reads the corners; of triangles that are not there, those of the last one.
  void gather(mesh_view<S> const& mesh, std::size_t first, std::size_t n) {
    auto const take = [&](std::size_t i, auto const& corner_of) {
      for (unsigned c = 0; c < 3; ++c) {
        auto const& p = corner_of(first + min(i, n - 1), c);
        for (int k = 0; k < 3; ++k) corners[c][k][i] = p[k];
      }
    };
    auto const& points = mesh.vertices();
    if (points.packed() && mesh.indices() != nullptr && mesh.packed_indices()) {  // strides that the compiler knows
      S const* const x = points.address(0);
      id const* const numbers = mesh.indices();
      for (std::size_t i = 0; i < size; ++i) {
        take(i, [&](std::size_t t, unsigned c) { return x + 3 * std::size_t{numbers[3 * t + c]}; });
      }
    } else {
      for (std::size_t i = 0; i < size; ++i) {
        take(i, [&](std::size_t t, unsigned c) { return points[mesh.corner(t, c)]; });
      }
    }
  }

  /// The least of all values, as `f` of two says.
  template <class F>
  static S reduced(S const (&values)[size], F const& f) {
    S half[size / 2];
    for (std::size_t i = 0; i < size / 2; ++i) half[i] = f(values[i], values[i + size / 2]);
    return f(f(half[0], half[1]), f(half[2], half[3]));
  }

  S outside(int k, std::uint32_t i, S x) const {
    S const distance = max(lower[k][i] - x, x - upper[k][i]);
    return select(distance > 0, distance, S(0));
  }
};

/// True if the box around a group is not much larger than a cell, and so meets hardly more of them than its triangles
/// do.
template <class S>
bool is_small(triangle_aabb<S> const& group, grid<S> const& g) {
  return g.levels == 1 && group.max_extent() <= 2 * g.width;
}

/// Calls f(number, n) for the runs of cells, of the one level of a grid, that the dilated box around a group meets: no
/// cell twice.
template <class S, class F>
void each_range_of_group(grid<S> const& g, aabb<S> const& group, F const& f) {
  grid_level<S> const& l = g.level[0];
  cell_box const r = g.range_of(l, group);
  bool turns = false;
  COLLIDE_UNROLL
  for (int k = 0; k < 3; ++k) turns = turns || r.upper[k] - r.lower[k] > l.mask[k];
  each_range_of_box(l, turns ? triangle_cells<S>(g, l, group).range() : r, f);
}

}  // namespace collide::detail
