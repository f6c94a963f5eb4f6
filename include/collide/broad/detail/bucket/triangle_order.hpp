/// \file
/// Triangles in an order in which neighbours follow each other, for the CPU: it looks at eight triangles at a time, and
/// that pays where these are close to each other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/bucket/triangle_group.hpp>
#include <collide/core/memory.hpp>
#include <collide/mesh.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

struct triangle_on_curve {
  std::uint32_t place;
  id number;
};

/// The place on Morton's curve through a cube, of 30 bits, from coordinates of 10 bits.
inline std::uint32_t morton_place(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  auto const spread = [](std::uint32_t v) {
    v = (v | v << 16) & 0x030000ffu;
    v = (v | v << 8) & 0x0300f00fu;
    v = (v | v << 4) & 0x030c30c3u;
    return (v | v << 2) & 0x09249249u;
  };
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

/// Some of the groups of a mesh: whether their triangles are close to each other, and the box around them.
template <class S>
struct sampled_groups {
  static constexpr std::size_t max_count = 64;

  aabb<S> all = aabb<S>::empty();
  std::size_t groups = 0, wide = 0;

  explicit sampled_groups(mesh_view<S> const& mesh) {
    std::size_t const count = triangle_group<S>::count(mesh.size());
    std::size_t const samples = min(max_count, (count + 15) / 16);
    for (; groups < samples; ++groups) {
      triangle_group<S> group;
      multiversioned([&] { group.load(mesh, count * groups / samples * triangle_group<S>::size); });
      all = typename aabb<S>::merge{}(all, group.all);
      wide += is_wide(group);
    }
  }

  /// True if the triangles that follow each other are mostly far from each other.
  bool has_order() const { return 4 * wide <= groups; }

 private:
  /// True if the box around a group is much larger than those of the triangles side by side.
  static bool is_wide(triangle_group<S> const& group) {
    S each = 0;
    for (std::uint32_t i = 0; i < triangle_group<S>::size; ++i) {
      if (group.has(i)) each += squared_extent(group.box(i));
    }
    return group.there != 0 && squared_extent(group.all) > 4 * each;
  }

  static S squared_extent(aabb<S> const& b) {
    S const sum = (b.upper[0] - b.lower[0]) + (b.upper[1] - b.lower[1]) + (b.upper[2] - b.lower[2]);
    return sum * sum;
  }
};

/// Kernel functor of `for_each` over groups: where the first corners of their triangles are on the curve. The others
/// are not read: in a mesh without order each is somewhere else in memory.
template <class S>
struct place_on_morton_curve {
  mesh_view<S> mesh;
  aabb<S> around;  ///< about the mesh: what is outside of it counts as on its surface
  S scale;         ///< cells of the curve in a unit of length
  triangle_on_curve* to;

  void operator()(std::size_t i) const {
    constexpr std::size_t n = triangle_group<S>::size;
    std::size_t const first = i * n, there = min(n, mesh.size() - first);
    constexpr std::size_t ahead = 64;
    for (std::size_t k = first + ahead; k < first + ahead + n && k < mesh.size(); ++k) {
      __builtin_prefetch(mesh.vertices().address(mesh.corner(k, 0)));
    }
    S corners[3][n] = {};
    for (std::size_t k = 0; k < there; ++k) {
      vec3<S> const corner = mesh.vertices()[mesh.corner(first + k, 0)];
      for (int axis = 0; axis < 3; ++axis) corners[axis][k] = corner[axis];
    }
    std::uint32_t places[n];
    multiversioned([&] {
      for (std::size_t k = 0; k < n; ++k) {
        std::uint32_t x[3];
        for (int axis = 0; axis < 3; ++axis) {
          S const at = min(max(S(0), (corners[axis][k] - around.lower[axis]) * scale), S(1023));
          x[axis] = static_cast<std::uint32_t>(static_cast<std::int32_t>(at));
        }
        places[k] = morton_place(x[0], x[1], x[2]);
      }
    });
    for (std::size_t k = 0; k < there; ++k) to[first + k] = {places[k], static_cast<id>(first + k)};
  }
};

/// The numbers up to n, in parts for blocks on the host.
struct parts_of {
  static constexpr std::size_t max_count = 16, min_size = 1 << 14;

  std::size_t n, count, share;

  template <class Space>
  parts_of(Space const& space, std::size_t size)
      : n{size},
        count{std::min({n / min_size + 1, space.saturating_blocks(), max_count})},
        share{(n + count - 1) / count} {}

  std::size_t begin(std::size_t part) const { return std::min(part * share, n); }
  template <class F>
  void each_of(std::size_t part, F const& f) const {
    for (std::size_t i = begin(part), end = begin(part + 1); i < end; ++i) f(i);
  }
};

/// Brings triangles into the order of ten bits of their places, from `from` to `to`; those of equal bits stay as they
/// are. O(n).
template <class Space>
void sort_by_digit(Space& space, triangle_on_curve const* from, triangle_on_curve* to, std::size_t n, int shift) {
  constexpr std::size_t digits = 1 << 10;
  parts_of const parts(space, n);
  std::uint32_t begins[parts_of::max_count][digits] = {};
  auto const digit = [&](std::size_t i) { return from[i].place >> shift & (digits - 1); };
  for_each_block(space, parts.count,
                 [&](std::size_t p) { parts.each_of(p, [&](std::size_t i) { ++begins[p][digit(i)]; }); });
  std::uint32_t begin = 0;
  for (std::size_t d = 0; d < digits; ++d) {
    for (std::size_t p = 0; p < parts.count; ++p) {
      std::uint32_t const count = begins[p][d];
      begins[p][d] = begin;
      begin += count;
    }
  }
  for_each_block(space, parts.count,
                 [&](std::size_t p) { parts.each_of(p, [&](std::size_t i) { to[begins[p][digit(i)]++] = from[i]; }); });
}

/// A mesh as groups of triangles that are close to each other: its own triangles eight by eight, or others.
template <class S>
struct grouped_mesh {
  mesh_view<S> mesh;  ///< eight triangles for each group; what a group has not, it repeats
  id const* numbers;  ///< that the triangles have for the caller, `no_id` of repeated ones; null if all have their own

  std::size_t size() const { return triangle_group<S>::count(mesh.size()); }

  void load(triangle_group<S>& group, std::size_t i) const {
    constexpr std::size_t n = triangle_group<S>::size;
    group.load(mesh, i * n);
    for (std::uint32_t k = 1; numbers != nullptr && k < n; ++k) {
      if (numbers[i * n + k] == no_id) group.there &= ~(1u << k);
    }
  }

  /// The number that a triangle of a group has for the caller.
  id number_of(id triangle) const { return numbers == nullptr ? triangle : numbers[triangle]; }
};

/// Finds the groups of a mesh: as its triangles follow each other if these are close, else along Morton's curve.
template <class S>
class group_triangles {
 public:
  /// Finds the order. O(triangles); memory only if the triangles of the mesh have no such order: about 35 bytes for
  /// each.
  template <class Space>
  grouped_mesh<S> operator()(Space& space, mesh_view<S> const& mesh) {
    std::size_t const n = mesh.size();
    sampled_groups<S> const sample(mesh);
    if (sample.has_order() || n > ~id(0) / 8) return {mesh, nullptr};
    S extent = 0;
    for (int k = 0; k < 3; ++k) extent = max(extent, sample.all.upper[k] / 2 - sample.all.lower[k] / 2);
    triangle_on_curve* const order = order_.reserve(space.resource(), n);
    triangle_on_curve* const spare = spare_.reserve(space.resource(), n + 1);
    space.for_each(triangle_group<S>::count(n), place_on_morton_curve<S>{mesh, sample.all, S(512) / extent, spare});
    sort_by_digit(space, spare, order, n, 0);
    sort_by_digit(space, order, spare, n, 10);
    sort_by_digit(space, spare, order, n, 20);
    id* const begins = reinterpret_cast<id*>(spare);
    std::size_t groups = 0;
    divide(order, 0, static_cast<id>(n), 1u << 29, begins, groups);
    begins[groups] = static_cast<id>(n);
    constexpr std::size_t size = triangle_group<S>::size;
    id* const numbers = numbers_.reserve(space.resource(), size * groups);
    id* const corners = corners_.reserve(space.resource(), 3 * size * groups);
    space.for_each(groups, [=](std::size_t g) {
      constexpr std::size_t ahead = 8;
      if (mesh.packed_indices() && mesh.indices() != nullptr && g + ahead < groups) {
        for (id k = begins[g + ahead]; k < begins[g + ahead + 1]; ++k) {
          __builtin_prefetch(mesh.indices() + 3 * std::size_t{order[k].number});
        }
      }
      for (id k = 0; k < size; ++k) {
        id const at = min(begins[g] + k, begins[g + 1] - 1);
        std::size_t const i = size * g + k;
        numbers[i] = at == begins[g] + k ? order[at].number : no_id;
        for (unsigned c = 0; c < 3; ++c) corners[3 * i + c] = static_cast<id>(mesh.corner(order[at].number, c));
      }
    });
    return {mesh_view<S>(mesh.vertices(), corners, size * groups), numbers};
  }

 private:
  /// Divides triangles that have the higher bits of their places in common, into groups that do not reach across the
  /// boundary of a cell with many.
  static void divide(triangle_on_curve const* order, id begin, id end, std::uint32_t bit, id* begins,
                     std::size_t& groups) {
    constexpr id few = 32, size = triangle_group<S>::size;
    id const n = end - begin;
    if (n > few && bit != 0) {
      auto const middle = std::partition_point(order + begin, order + end,
                                               [&](triangle_on_curve const& t) { return (t.place & bit) == 0; });
      id const at = static_cast<id>(middle - order);
      divide(order, begin, at, bit / 2, begins, groups);
      divide(order, at, end, bit / 2, begins, groups);
      return;
    }
    id const parts = (n + size - 1) / size;
    for (id part = 0; part < parts; ++part) {
      begins[groups++] = begin + static_cast<id>(std::uint64_t{n} * part / parts);
    }
  }

  buffer<triangle_on_curve> order_, spare_;
  buffer<id> numbers_, corners_;
};

}  // namespace collide::detail
