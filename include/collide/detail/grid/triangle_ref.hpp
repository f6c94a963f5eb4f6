/// \file
/// Which triangles a single sphere could touch, asked from inside a kernel: what a broad phase gives a simulation.
///
/// An index gives a trivially copyable `triangle_ref()`. Of that, `has_single_cell_lookup(radius)` is true if spheres
/// of this radius are best asked several at a time whether they can touch a triangle:
/// `occupancy().test_occupied(occupancy().places_of(x, y, z), near)`, or `occupancy().test_swept(batch, near)` of those
/// that move. In a kernel, `without_overflown_grids()` is that lookup for use, and then
///   - `empty(sphere)` is true if the sphere can touch no triangle: it is quick;
///   - `begin(sphere)` is a cursor, and `next(sphere, cursor, most, range)` moves it on and gives at most `most` more
///     entries, until it returns false; one may appear more than once if the sphere moves; `cursor.at_end()` is true if
///     it is known to return false the next time;
///   - `range.at(k)` is an entry, which is a triangle, `range.passes_coverage(entry)` a quick test whether the sphere
///     could touch it, and `near(around, triangle)` one whether a sphere could all of whose path is in the sphere
///     `around`.
#pragma once

#include <cstdint>

#include <collide/detail/geometry/aabb.hpp>
#include <collide/detail/geometry/swept_bounds.hpp>
#include <collide/detail/grid/cell_coverage.hpp>
#include <collide/detail/narrow_phase/intersects.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

/// Entries that follow each other in memory, or in number.
struct candidate_range {
  cell_item const* listed;  ///< those of a cell; null: there are all, numbered from `first`
  id first;
  std::uint32_t count;
  std::uint32_t coverage;  ///< of the sphere, or of its path, in the cell

  COLLIDE_HD_INLINE cell_item at(std::uint32_t k) const {
    return listed != nullptr ? listed[k] : cell_item{first + k, cell_coverage::full_box};
  }
  COLLIDE_HD_INLINE bool passes_coverage(cell_item const& e) const {
    return cell_coverage::overlaps(e.coverage, coverage);
  }
};

/// How far the candidates of a sphere have been gone through.
struct candidate_cursor {
  static constexpr int ended = -1;  ///< in place of a grid's number

  int grid, level;
  std::uint32_t step, skip;

  /// True if there are no more. False where that is not known yet.
  COLLIDE_HD_INLINE bool at_end() const { return grid == ended; }
};

/// What both lookups share: the triangles, and a cheap test for each.
template <class S>
struct triangle_ref {
  mesh_view<S> mesh;
  triangle_aabb<S> const* boxes;  ///< may be null

  COLLIDE_HD_INLINE bool near(sphere<S> const& around, id triangle) const {
    return boxes == nullptr || boxes[triangle].overlaps(around.centre, around.radius);
  }

  /// Whether a triangle that has passed the quick tests is near, unless the narrow phase asks that itself before
  /// anything else.
  template <class NarrowPhase, class Sphere>
  COLLIDE_HD_INLINE bool aabb_overlaps_unless_filtered(Sphere const& shape, id triangle) const {
    if constexpr (filtered_predicate<NarrowPhase>::value) {
      return true;
    } else {
      return near(swept_bounding_sphere(shape), triangle);
    }
  }

  COLLIDE_HD_INLINE aabb<S> box_at(id triangle) const {
    return boxes != nullptr ? boxes[triangle] : triangle_aabb_of(mesh[triangle]);
  }

  /// All triangles, one range after the other.
  COLLIDE_HD bool next_of_all(candidate_cursor& c, std::uint32_t most, candidate_range& range) const {
    auto const n = static_cast<std::uint32_t>(mesh.size());
    if (c.skip >= n) return false;
    range = {nullptr, c.skip, min(n - c.skip, most), cell_coverage::full_query};
    c.skip += range.count;
    if (c.skip == n) c.grid = candidate_cursor::ended;
    return true;
  }
};

/// In place of a lookup, if nothing asks.
struct null_ref {};

}  // namespace collide::detail
