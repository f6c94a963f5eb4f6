/// \file
/// A reference to grids for a single sphere. The members are those of mesh_lookup.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/grid/grid.hpp>
#include <collide/broad/detail/grid/occupancy.hpp>
#include <collide/broad/detail/grid/swept_cells.hpp>
#include <collide/broad/detail/mesh_lookup.hpp>

namespace collide::detail {

/// The lookup of `bucket`: the grids, as bucket.cuh has them.
template <class S>
struct bucket_ref : mesh_lookup<S> {
  grid<S> const* grids;
  int grid_count;
  std::uint8_t const* occupied;
  item_range const* lists;
  std::uint32_t const* total;
  cell_item const* entries;
  std::size_t capacity;

  static constexpr std::int8_t no_candidates = candidate_cursor::ended, no_grid = -2;  ///< in place of a grid's number

  /// Without the grids that are not in use, and without any if they have no entries, or these have found no room.
  COLLIDE_HD bucket_ref opened() const {
    bucket_ref open = *this;
    while (open.grid_count > 1 && grids[open.grid_count - 1].reach < 0) --open.grid_count;
    if (grid_count > 0 && (lists == nullptr || *total > capacity)) open.grid_count = 0;
    return open;
  }

  COLLIDE_HD_INLINE bool is_occupied(std::uint32_t cell) const { return (occupied[cell / 8] >> cell % 8 & 1) != 0; }

  /// Which grid serves each of the spheres of a pack, if there may be triangles near it; `no_candidates` if not,
  /// `no_grid` if no grid serves it.
  template <class Pack, unsigned N>
  COLLIDE_HD_INLINE void locate(Pack const& pack, std::int8_t (&number)[N]) const {
    select_grids(pack, number);
    for (unsigned k = 0; k < N; ++k) {
      if (number[k] >= 0 && has_no_candidates_in(grids[number[k]], pack.shape(k))) number[k] = no_candidates;
    }
  }

  /// True if the sphere can touch no triangle.
  template <class Sphere>
  COLLIDE_HD_INLINE bool empty(Sphere const& shape) const {
    if (this->mesh.size() == 0) return true;
    std::int8_t number[1];
    locate(pack_of_one<Sphere>{shape}, number);
    return number[0] == no_candidates;
  }

  /// True if a sphere of this radius looks into one cell of one level, wherever it is, or into the few cells of its
  /// path if that is short. All that this depends on is read at once.
  COLLIDE_HD_INLINE bool has_single_cell_lookup(S radius) const {
    if (grid_count != 1) return false;
    bool const complete = *total <= capacity, one_level = grids[0].levels == 1, served = radius <= grids[0].reach;
    return complete & one_level & served & is_valid_radius(radius);
  }

  /// The occupancy of the cells, for spheres with `has_single_cell_lookup`. May be read before that is checked.
  COLLIDE_HD_INLINE occupancy_view<S> occupancy() const {
    if (grid_count != 1) return {};
    grid<S> const& g = grids[0];
    return {{g.lower[0], g.lower[1], g.lower[2]},
            {to_bits(g.upper[0] - g.lower[0]), to_bits(g.upper[1] - g.lower[1]), to_bits(g.upper[2] - g.lower[2])},
            g.level[0],
            occupied};
  }

  template <class Sphere>
  COLLIDE_HD candidate_cursor begin(Sphere const& shape) const {
    std::int8_t number[1] = {no_candidates};
    if (this->mesh.size() != 0) select_grids(pack_of_one<Sphere>{shape}, number);
    return {number[0], 0, 0, 0};
  }

  template <class Sphere>
  COLLIDE_HOT COLLIDE_HD bool next(Sphere const& shape, candidate_cursor& c, std::uint32_t max_count,
                                   candidate_range& range) const {
    if (c.grid == no_candidates) return false;
    if (c.grid == no_grid) return this->next_of_all(c, max_count, range);
    grid<S> const& g = grids[c.grid];
    for (; c.level < g.levels; ++c.level, c.step = 0) {
      if (!next_of_level(g, g.level[c.level], shape, c, max_count, range)) continue;
      if (c.level + 1 == g.levels && was_last(shape, c)) c.grid = no_candidates;
      return true;
    }
    c.grid = no_candidates;
    return false;
  }

 private:
  template <class Sphere>
  struct pack_of_one {
    Sphere const& only;
    COLLIDE_HD_INLINE Sphere const& shape(unsigned) const { return only; }
  };

  /// The tightest grid that serves each sphere; grids come by falling reach.
  template <class Pack, unsigned N>
  COLLIDE_HD_INLINE void select_grids(Pack const& pack, std::int8_t (&number)[N]) const {
    for (unsigned k = 0; k < N; ++k) number[k] = is_sound(pack.shape(k)) ? no_grid : no_candidates;
    COLLIDE_NO_UNROLL
    for (int g = 0; g < grid_count; ++g) {
      for (unsigned k = 0; k < N; ++k) {
        // a sphere without candidates stays so: its radius may be NaN, and -ffast-math may compare that either way
        bool const served = (number[k] != no_candidates) & serves(grids[g], pack.shape(k));
        std::int8_t const there = meets(grids[g], pack.shape(k)) ? static_cast<std::int8_t>(g) : no_candidates;
        number[k] = served ? there : number[k];
      }
    }
  }

  /// The centre of a sphere at rest is not looked at: it is in no grid if it is NaN.
  static COLLIDE_HD_INLINE bool is_sound(sphere<S> const& shape) { return is_valid_radius(shape.radius); }
  static COLLIDE_HD_INLINE bool is_sound(moving_sphere<S> const& shape) {
    return is_valid_radius(shape.radius) && is_finite(shape.centre) && is_finite(shape.displacement);
  }

  static COLLIDE_HD_INLINE bool serves(grid<S> const& g, sphere<S> const& shape) { return g.serves(shape.radius); }
  static COLLIDE_HD_INLINE bool meets(grid<S> const& g, sphere<S> const& shape) {
    return g.contains(shape.centre.x(), shape.centre.y(), shape.centre.z());
  }

  static COLLIDE_HD_INLINE bool serves(grid<S> const& g, moving_sphere<S> const& shape) {
    S const inverse_width = g.levels > 0 ? g.level[0].inverse_width : S(0);
    bool served = g.serves(shape.radius);
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      served = served && swept_cells<S>::is_traversable(g.lower[k], g.upper[k], inverse_width, shape.centre[k],
                                                        shape.displacement[k]);
    }
    return served;
  }
  static COLLIDE_HD_INLINE bool meets(grid<S> const& g, moving_sphere<S> const& shape) {
    bool inside = true;
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      inside = inside && swept_cells<S>::overlaps_slab(g.lower[k], g.upper[k], shape.centre[k], shape.displacement[k]);
    }
    return inside;
  }

  /// True if no level has triangles near a sphere that this grid serves.
  template <class Sphere>
  COLLIDE_HD_INLINE bool has_no_candidates_in(grid<S> const& g, Sphere const& shape) const {
    COLLIDE_NO_UNROLL
    for (int l = 0; l < g.levels; ++l) {
      if (!empty_level(g, g.level[l], shape)) return false;
    }
    return true;
  }
  COLLIDE_HD_INLINE bool empty_level(grid<S> const& g, grid_level<S> const& l, sphere<S> const& shape) const {
    return !is_occupied(g.cell_at(l, shape.centre).number);
  }
  COLLIDE_HD_INLINE bool empty_level(grid<S> const& g, grid_level<S> const& l, moving_sphere<S> const& shape) const {
    cell_box const r = swept_cells<S>::cell_box_of_path(g, l, shape.centre, shape.displacement);
    if (!swept_cells<S>::is_short(r)) return false;  // is looked at more closely when it is walked
    bool found = false;
    for (std::uint32_t z = r.lower[2]; z <= r.upper[2]; ++z) {
      for (std::uint32_t y = r.lower[1]; y <= r.upper[1]; ++y) {
        std::uint32_t const row = l.row(y, z);
        for (std::uint32_t x = r.lower[0]; x <= r.upper[0]; ++x) {
          found = found || is_occupied(row + (x & l.mask[0]));
        }
      }
    }
    return !found;
  }

  /// The entries of a cell that have not been gone through; then the cursor is at the next step.
  COLLIDE_HD bool next_of_cell(std::uint32_t cell, std::uint32_t place, candidate_cursor& c, std::uint32_t max_count,
                               candidate_range& range) const {
    item_range const list = lists[cell];
    std::uint32_t const left = list.count - c.skip, some = min(left, max_count);
    if (left != 0) range = {entries + (list.end - left), 0, some, place};
    c.skip += some;
    if (some == left) {
      ++c.step;
      c.skip = 0;
    }
    return left != 0;
  }

  /// True if the cell that was gone through last is known to be the last one of a level: a sphere at rest is in one.
  static COLLIDE_HD_INLINE bool was_last(sphere<S> const&, candidate_cursor const& c) { return c.step != 0; }
  static COLLIDE_HD_INLINE bool was_last(moving_sphere<S> const&, candidate_cursor const&) { return false; }

  COLLIDE_HD bool next_of_level(grid<S> const& g, grid_level<S> const& l, sphere<S> const& shape, candidate_cursor& c,
                                std::uint32_t max_count, candidate_range& range) const {
    if (c.step != 0) return false;
    cell_ref const at = g.cell_at(l, shape.centre);
    return next_of_cell(at.number, at.coverage, c, max_count, range);
  }

  COLLIDE_HD bool next_of_level(grid<S> const& g, grid_level<S> const& l, moving_sphere<S> const& shape,
                                candidate_cursor& c, std::uint32_t max_count, candidate_range& range) const {
    swept_cells<S> const path(g, l, shape.centre, shape.displacement);
    while (c.step < path.steps()) {
      auto const here = path.at(c.step);
      std::uint32_t const cell = l.row(here.cell[1], here.cell[2]) + (here.cell[0] & l.mask[0]);
      if (!here.is_cell || !is_occupied(cell)) {
        ++c.step;
        c.skip = 0;
        continue;
      }
      if (next_of_cell(cell, here.coverage, c, max_count, range)) return true;
    }
    return false;
  }
};

}  // namespace collide::detail
