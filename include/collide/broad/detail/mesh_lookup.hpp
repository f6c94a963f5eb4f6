/// \file
/// Which triangles a single sphere could touch, asked from inside a kernel: what a broad phase gives a simulation.
///
/// An index gives a trivially copyable `mesh_lookup()`. Of that, `has_single_cell_lookup(radius)` is true if spheres
/// of this radius are best asked several at a time whether they can touch a triangle:
/// `occupancy().test_occupied(occupancy().places_of(x, y, z), near)`, or `occupancy().test_swept(batch, near)` of those
/// that move. In a kernel, `opened()` is that lookup for use, and then
///   - `empty(sphere)` is true if the sphere can touch no triangle: it is quick;
///   - `begin(sphere)` is a cursor, and `next(sphere, cursor, max_count, range)` moves it on and gives at most
///     `max_count` more entries, until it returns false; one may appear more than once if the sphere moves;
///     `cursor.at_end()` is true if it is known to return false the next time;
///   - `range.at(k)` is an entry, which is a triangle, `range.passes_coverage(entry)` a quick test whether the sphere
///     could touch it, and `near(around, triangle)` one whether a sphere could all of whose path is in the sphere
///     `around`.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/grid/grid.hpp>
#include <collide/broad/detail/grid/occupancy.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>
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

/// The base of all references: the triangles, and a cheap test for each.
template <class S>
struct mesh_lookup {
  using cursor_type = candidate_cursor;
  using range_type = candidate_range;

  mesh_view<S> mesh;
  triangle_aabb<S> const* boxes;  ///< may be null

  // What a reference without cells says of them; `bucket_ref` has its own.
  COLLIDE_HD bool has_single_cell_lookup(S) const { return false; }
  COLLIDE_HD occupancy_view<S> occupancy() const { return {}; }
  template <class Sphere>
  COLLIDE_HD bool empty(Sphere const&) const {
    return mesh.size() == 0;
  }
  template <class Sphere>
  COLLIDE_HD candidate_cursor begin(Sphere const&) const {
    return {0, 0, 0, 0};
  }

  COLLIDE_HD_INLINE bool near(sphere<S> const& around, id triangle) const {
    return boxes == nullptr || boxes[triangle].overlaps(around.centre, around.radius);
  }

  COLLIDE_HD_INLINE aabb<S> box_at(id triangle) const {
    return boxes != nullptr ? boxes[triangle] : triangle_aabb_of(mesh[triangle]);
  }

  /// All triangles, one range after the other.
  COLLIDE_HD bool next_of_all(candidate_cursor& c, std::uint32_t max_count, candidate_range& range) const {
    auto const n = static_cast<std::uint32_t>(mesh.size());
    if (c.skip >= n) return false;
    range = {nullptr, c.skip, min(n - c.skip, max_count), cell_coverage::full_query};
    c.skip += range.count;
    if (c.skip == n) c.grid = candidate_cursor::ended;
    return true;
  }
};

template <class S>
struct all_pairs_ref : mesh_lookup<S> {
  COLLIDE_HD all_pairs_ref const& opened() const { return *this; }
  template <class Sphere>
  COLLIDE_HD bool next(Sphere const&, candidate_cursor& c, std::uint32_t max_count, candidate_range& range) const {
    return this->next_of_all(c, max_count, range);
  }

  /// Calls f(triangle) for every triangle, whatever the bound is that it returns.
  template <class F>
  COLLIDE_HD void for_each_nearer(vec3<S> const&, S, F const& f) const {
    for (std::size_t t = 0; t < this->mesh.size(); ++t) f(static_cast<id>(t));
  }

  /// Calls f(triangle) for every triangle, as long as that returns true.
  template <class F>
  COLLIDE_HD void for_each_on_ray(vec3<S> const&, F const& f) const {
    for (std::size_t t = 0; t < this->mesh.size() && f(static_cast<id>(t)); ++t) {
    }
  }
};

}  // namespace collide::detail
