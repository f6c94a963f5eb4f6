/// \file
/// Which triangles a single sphere could touch, asked from inside a kernel: what a broad phase gives a simulation.
///
/// An index gives a trivially copyable `lookup()`. Of that, `is_simple(radius)` is true if balls of this radius are
/// best asked several at a time whether they can touch a triangle: `marks().mark(marks().places_of(x, y, z), near)`, or
/// `marks().mark_ways(batch, near)` of those that move; `next_marked` then is `next` of those at rest that were marked.
/// In a kernel, `opened()` is that lookup for use, and then
///   - `empty(ball)` is true if the ball can touch no triangle: it is quick;
///   - `begin(ball)` is a cursor, and `next(ball, cursor, most, range)` moves it on and gives the next at most `most`
///     entries, until it returns false; one may appear more than once if the ball moves; `cursor.at_end()` is true if
///     it is known to return false the next time;
///   - `range.at(k)` is an entry, of 2^`bits` triangles, `range.may_touch(entry)` a quick test whether the ball could
///     touch them, and `near(around, number)` one whether a ball could touch a triangle all of whose way is in the
///     ball `around`; `each_near(around, entry, f)` calls f(number) for those of an entry that are near.
#pragma once

#include <collide/detail/geometry/sphere_pack.hpp>
#include <collide/detail/geometry/swept_bounds.hpp>
#include <collide/detail/grid/grid.hpp>
#include <collide/detail/grid/swept_cells.hpp>
#include <collide/detail/narrow_phase/intersects.hpp>
#include <collide/detail/narrow_phase/spheres_of.hpp>

namespace collide::detail {

/// Entries that follow each other in memory, or in number.
struct candidate_range {
  cell_entry const* listed;  ///< those of a cell; null: there are all, numbered from `first`
  id first;
  std::uint32_t count;
  std::uint32_t place;  ///< of the ball, or of its way, in the cell

  COLLIDE_HD_INLINE cell_entry at(std::uint32_t k) const {
    return listed != nullptr ? listed[k] : cell_entry{first + k, cell_part::whole};
  }
  COLLIDE_HD_INLINE bool may_touch(cell_entry const& e) const { return cell_part::meets(e.part, place); }
};

/// How far the candidates of a ball have been gone through.
struct candidate_cursor {
  static constexpr int ended = -1;  ///< in place of a grid's number

  int grid, level;
  std::uint32_t step, skip;

  /// That of a ball which was marked.
  static COLLIDE_HD_INLINE candidate_cursor first_marked() { return {0, 0, 0, 0}; }

  /// True if there are no more. False where that is not known yet.
  COLLIDE_HD_INLINE bool at_end() const { return grid == ended; }
};

/// What both lookups share: the triangles, and a cheap test for each.
template <class S>
struct triangle_lookup {
  mesh_view<S> mesh;
  triangle_box<S> const* boxes;  ///< and one more, which may be anything; may be null
  std::uint32_t bits;            ///< log2 of how many triangles an entry is; the last ones need not exist

  COLLIDE_HD_INLINE bool near(sphere<S> const& around, id number) const {
    triangle_box<S> const box = boxes != nullptr ? boxes[number] : triangle_box<S>::everywhere();
    bool const reached = box.reached(around.centre, around.radius);
    return reached & (number < mesh.size());
  }

  /// Whether a triangle of an entry that has passed the quick tests exists, and is near unless the narrow phase asks
  /// that itself before anything else.
  template <class NarrowPhase, class Ball>
  COLLIDE_HD_INLINE bool may_touch(Ball const& ball, id number) const {
    if constexpr (in_stages<NarrowPhase>::value) {
      return number < mesh.size();
    } else {
      return near(enclosing(ball), number);
    }
  }

  /// The box around an entry.
  COLLIDE_HD_INLINE box<S> box_of(cell_entry const& e) const {
    box<S> const first = own_box(e.number << bits);
    if (bits == 0 || (e.number << bits) + 1 == mesh.size()) return first;
    return typename box<S>::unite{}(first, own_box((e.number << bits) + 1));
  }

  template <class F>
  COLLIDE_HD_INLINE void each_near(sphere<S> const& around, cell_entry const& e, F const& f) const {
    for (std::uint32_t k = 0; k >> bits == 0; ++k) {
      id const number = (e.number << bits) + k;
      if (near(around, number)) f(number);
    }
  }

  /// How many entries all triangles are.
  COLLIDE_HD_INLINE std::uint32_t entry_count() const {
    return static_cast<std::uint32_t>((mesh.size() + ((std::size_t{1} << bits) - 1)) >> bits);
  }

  /// All triangles, one range after the other.
  COLLIDE_HD bool next_of_all(candidate_cursor& c, std::uint32_t most, candidate_range& range) const {
    std::uint32_t const n = entry_count();
    if (c.skip >= n) return false;
    range = {nullptr, c.skip, smaller(n - c.skip, most), cell_part::anywhere};
    c.skip += range.count;
    if (c.skip == n) c.grid = candidate_cursor::ended;
    return true;
  }

 private:
  COLLIDE_HD_INLINE box<S> own_box(id number) const {
    return boxes != nullptr ? boxes[number] : triangle_box_of(mesh[number]);
  }
};

/// In place of a lookup, if nothing asks.
struct no_lookup {};

/// Which cells have triangles, of the one level of the one grid that serves balls of one radius: all that most balls
/// are asked, small enough to be kept in registers.
template <class S>
struct cell_marks {
  S lower[3];
  bits_of<S> extent[3];  ///< as bits, which are in the order of the numbers from 0 on; all others are larger
  grid_level<S> level;
  std::uint8_t const* occupied;

  /// The cell of a centre that was marked, and the place of the centre in it.
  COLLIDE_HD_INLINE covered_cell place_of(vec3<S> const& centre) const { return level.place_of(centre, lower); }

  /// The cells of several centres, and whether each is inside the grid at all.
  template <int N>
  struct places {
    std::uint32_t cells[N], inside[N];
  };

  /// Without branches, for the CPU's vector unit.
  template <int N>
  COLLIDE_HD_INLINE places<N> places_of(S const (&x)[N], S const (&y)[N], S const (&z)[N]) const {
    places<N> p;
    for (int k = 0; k < N; ++k) {
      S const dx = x[k] - lower[0], dy = y[k] - lower[1], dz = z[k] - lower[2];
      p.inside[k] = bits(dx) <= extent[0] ? 1u : 0u;
      p.inside[k] &= bits(dy) <= extent[1] ? 1u : 0u;
      p.inside[k] &= bits(dz) <= extent[2] ? 1u : 0u;
      std::uint32_t const cell = level.row(level.coordinate_inside(dy), level.coordinate_inside(dz)) +
                                 (level.coordinate_inside(dx) & level.mask[0]);
      p.cells[k] = p.inside[k] != 0 ? cell : level.first;  // outside there are no cells
    }
    return p;
  }

  /// Whether there may be triangles near each of the centres.
  template <int N>
  COLLIDE_HD_INLINE void mark(places<N> const& p, bool (&near)[N]) const {
    for (int k = 0; k < N; ++k) near[k] = (p.inside[k] & occupied[p.cells[k] / 8] >> p.cells[k] % 8 & 1) != 0;
  }
  COLLIDE_HD_INLINE bool is_marked(std::uint32_t cell) const { return (bit_of(cell) & 1) != 0; }

  /// The same of spheres that move. False if it is not known: one of them is not finite, or goes a long way in the
  /// grid.
  template <int N>
  COLLIDE_HD_INLINE bool mark_ways(moving_batch<S, N> const& b, bool (&near)[N]) const {
    bool known = true;
    std::uint32_t first[N], apart[N][3];  // the first cell, and how far from it the second on each axis is
    for (int k = 0; k < N; ++k) {
      cells_on_axis const on[3] = {cells_on(0, b.x[k], b.dx[k]), cells_on(1, b.y[k], b.dy[k]),
                                   cells_on(2, b.z[k], b.dz[k])};
      bool const inside = (on[0].inside & on[1].inside & on[2].inside) != 0;
      bool const is_short = on[0].more <= 1 && on[1].more <= 1 && on[2].more <= 1;
      // what is not finite is not in the cells that it seems to be in
      known = known && finite(on[0].extent + (on[1].extent + on[2].extent)) && (is_short || !inside);
      near[k] = inside;
      first[k] = level.first + (inside ? on[0].begin + (on[1].begin + on[2].begin) : 0);
      for (int axis = 0; axis < 3; ++axis) apart[k][axis] = inside ? on[axis].end - on[axis].begin : 0;
    }
    if (!known) return false;
    for (int k = 0; k < N; ++k) {
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
  /// The cells of a way on an axis, as `way` has them.
  struct cells_on_axis {
    std::uint32_t inside, begin, end;  ///< cells: what they add to the number of a cell
    std::uint32_t more;                ///< cells than one
    S extent;
  };

  COLLIDE_HD_INLINE cells_on_axis cells_on(int axis, S from, S along) const {
    S const to = from + along, slack = way<S>::slack_of(from, along), most = from_bits<S>(extent[axis]);
    S const least = smaller(from, to) - slack - lower[axis], last = larger(from, to) + slack - lower[axis];
    std::uint32_t const begin = level.coordinate_inside(smaller(least, most)),
                        end = level.coordinate_inside(smaller(last, most));
    std::uint32_t const stride = axis == 0 ? 1 : level.stride[axis - 1];
    return {(least <= most ? 1u : 0u) & (last >= 0 ? 1u : 0u), (begin & level.mask[axis]) * stride,
            (end & level.mask[axis]) * stride, end - begin, last - least};
  }

  /// In the lowest bit, whether the cell has triangles.
  COLLIDE_HD_INLINE std::uint32_t bit_of(std::uint32_t cell) const {
    return static_cast<std::uint32_t>(occupied[cell / 8]) >> cell % 8;
  }
};

/// The lookup of `all_pairs`.
template <class S>
struct all_pairs_lookup : triangle_lookup<S> {
  COLLIDE_HD all_pairs_lookup const& opened() const { return *this; }

  template <class Ball>
  COLLIDE_HD bool empty(Ball const&) const {
    return this->mesh.size() == 0;
  }
  COLLIDE_HD bool is_simple(S) const { return false; }
  COLLIDE_HD cell_marks<S> marks() const { return {}; }
  template <class Ball>
  COLLIDE_HD candidate_cursor begin(Ball const&) const {
    return {0, 0, 0, 0};
  }
  template <class Ball>
  COLLIDE_HD bool next(Ball const&, candidate_cursor& c, std::uint32_t most, candidate_range& range) const {
    return this->next_of_all(c, most, range);
  }
  COLLIDE_HD bool next_marked(cell_marks<S> const&, vec3<S> const&, candidate_cursor&, std::uint32_t,
                              candidate_range&) const {
    return false;
  }
};

/// The lookup of `bucket`: the grids, as bucket.cuh has them.
template <class S>
struct bucket_lookup : triangle_lookup<S> {
  grid<S> const* grids;
  int grid_count;
  std::uint8_t const* occupied;
  cell_list const* lists;
  std::uint32_t const* total;
  cell_entry const* entries;
  std::size_t capacity;

  static constexpr int nowhere = candidate_cursor::ended, everywhere = -2;  ///< in place of a grid's number

  COLLIDE_HD bucket_lookup opened() const {
    bucket_lookup open = *this;
    if (grid_count > 0) open.bits = grids[0].bits;
    if (grid_count > 0 && *total > capacity) open.grid_count = 0;
    return open;
  }

  COLLIDE_HD_INLINE bool is_occupied(std::uint32_t cell) const { return (occupied[cell / 8] >> cell % 8 & 1) != 0; }

  template <class Ball>
  COLLIDE_HD_INLINE bool empty(Ball const& ball) const {
    if (this->mesh.size() == 0) return true;
    int const g = grid_of(ball);
    return g < 0 ? g == nowhere : empty_in(grids[g], ball);
  }

  /// The same, of a ball that this grid serves.
  template <class Ball>
  COLLIDE_HD_INLINE bool empty_in(grid<S> const& g, Ball const& ball) const {
    COLLIDE_ROLLED
    for (int l = 0; l < g.levels; ++l) {
      if (!empty_level(g, g.level[l], ball)) return false;
    }
    return true;
  }

  /// True if a ball of this radius looks into one cell of one level, wherever it is, and into the few of its way if
  /// that is short. All that this depends on is read at once.
  COLLIDE_HD_INLINE bool is_simple(S radius) const {
    if (grid_count != 1) return false;
    bool const complete = *total <= capacity, one_level = grids[0].levels == 1, served = radius <= grids[0].reach;
    return complete & one_level & served & valid_radius(radius);
  }

  /// Then, what tells it; may be asked before that is known.
  COLLIDE_HD_INLINE cell_marks<S> marks() const {
    if (grid_count != 1) return {};
    grid<S> const& g = grids[0];
    return {{g.lower[0], g.lower[1], g.lower[2]},
            {bits(g.upper[0] - g.lower[0]), bits(g.upper[1] - g.lower[1]), bits(g.upper[2] - g.lower[2])},
            g.level[0],
            occupied};
  }

  template <class Ball>
  COLLIDE_HD candidate_cursor begin(Ball const& ball) const {
    return {this->mesh.size() == 0 ? nowhere : grid_of(ball), 0, 0, 0};
  }

  template <class Ball>
  COLLIDE_HD bool next(Ball const& ball, candidate_cursor& c, std::uint32_t most, candidate_range& range) const {
    if (c.grid == nowhere) return false;
    if (c.grid == everywhere) return this->next_of_all(c, most, range);
    grid<S> const& g = grids[c.grid];
    for (; c.level < g.levels; ++c.level, c.step = 0) {
      if (!next_of_level(g, g.level[c.level], ball, c, most, range)) continue;
      if (c.level + 1 == g.levels && was_last(ball, c)) c.grid = nowhere;
      return true;
    }
    c.grid = nowhere;
    return false;
  }

  /// The same of a ball that was marked: from what is known of its cell, without asking the grid. Its cursor begins
  /// with `candidate_cursor::first_marked()`.
  COLLIDE_HD_INLINE bool next_marked(cell_marks<S> const& marks, vec3<S> const& centre, candidate_cursor& c,
                                     std::uint32_t most, candidate_range& range) const {
    if (c.grid == nowhere) return false;
    covered_cell const at = marks.place_of(centre);
    bool const some = next_of_cell(at.number, at.part, c, most, range);
    if (c.step != 0) c.grid = nowhere;
    return some;
  }

 private:
  /// The tightest grid that serves a ball; grids come by falling reach.
  template <class Ball>
  COLLIDE_HD_INLINE int grid_of(Ball const& ball) const {
    if (!valid_radius(ball.radius) || !finite_way(ball)) return nowhere;
    int number = everywhere;
    COLLIDE_ROLLED
    for (int g = 0; g < grid_count; ++g) {
      if (!serves(grids[g], ball)) continue;
      number = meets(grids[g], ball) ? g : nowhere;
    }
    return number;
  }

  /// Of a ball at rest this is not asked: it is in no grid if its centre is NaN.
  static COLLIDE_HD_INLINE bool finite_way(sphere<S> const&) { return true; }
  static COLLIDE_HD_INLINE bool finite_way(moving_sphere<S> const& ball) {
    return finite(ball.centre) && finite(ball.displacement);
  }

  static COLLIDE_HD_INLINE bool serves(grid<S> const& g, sphere<S> const& ball) { return ball.radius <= g.reach; }
  static COLLIDE_HD_INLINE bool meets(grid<S> const& g, sphere<S> const& ball) {
    std::uint32_t inside = 1;  // without branches
    for (int k = 0; k < 3; ++k) {
      inside &= ball.centre[k] >= g.lower[k] ? 1u : 0u;
      inside &= ball.centre[k] <= g.upper[k] ? 1u : 0u;
    }
    return inside != 0;
  }

  static COLLIDE_HD_INLINE bool serves(grid<S> const& g, moving_sphere<S> const& ball) {
    S const inverse_width = g.levels > 0 ? g.level[0].inverse_width : S(0);
    bool served = ball.radius <= g.reach;
    for (int k = 0; k < 3; ++k) {
      served = served && way<S>::can_walk(g.lower[k], g.upper[k], inverse_width, ball.centre[k], ball.displacement[k]);
    }
    return served;
  }
  static COLLIDE_HD_INLINE bool meets(grid<S> const& g, moving_sphere<S> const& ball) {
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      inside = inside && way<S>::enters(g.lower[k], g.upper[k], ball.centre[k], ball.displacement[k]);
    }
    return inside;
  }

  COLLIDE_HD_INLINE bool empty_level(grid<S> const& g, grid_level<S> const& l, sphere<S> const& ball) const {
    return !is_occupied(g.cell_of(l, ball.centre));
  }
  COLLIDE_HD_INLINE bool empty_level(grid<S> const& g, grid_level<S> const& l, moving_sphere<S> const& ball) const {
    cell_range const r = way<S>::cells_around(g, l, ball.centre, ball.displacement);
    if (!way<S>::is_short(r)) return false;  // is looked at more closely when it is walked
    bool occupied = false;
    for (std::uint32_t z = r.lower[2]; z <= r.upper[2]; ++z) {
      for (std::uint32_t y = r.lower[1]; y <= r.upper[1]; ++y) {
        std::uint32_t const row = l.row(y, z);
        for (std::uint32_t x = r.lower[0]; x <= r.upper[0]; ++x) {
          occupied = occupied || is_occupied(row + (x & l.mask[0]));
        }
      }
    }
    return !occupied;
  }

  /// The entries of a cell that have not been gone through; then the cursor is at the next step.
  COLLIDE_HD bool next_of_cell(std::uint32_t cell, std::uint32_t place, candidate_cursor& c, std::uint32_t most,
                               candidate_range& range) const {
    cell_list const list = lists[cell];
    std::uint32_t const left = list.count - c.skip, some = smaller(left, most);
    if (left != 0) range = {entries + (list.end - left), 0, some, place};
    c.skip += some;
    if (some == left) {
      ++c.step;
      c.skip = 0;
    }
    return left != 0;
  }

  /// Whether the cell that was gone through last is known to be the last one of a level: a ball at rest is in one.
  static COLLIDE_HD_INLINE bool was_last(sphere<S> const&, candidate_cursor const& c) { return c.step != 0; }
  static COLLIDE_HD_INLINE bool was_last(moving_sphere<S> const&, candidate_cursor const&) { return false; }

  COLLIDE_HD bool next_of_level(grid<S> const& g, grid_level<S> const& l, sphere<S> const& ball, candidate_cursor& c,
                                std::uint32_t most, candidate_range& range) const {
    if (c.step != 0) return false;
    covered_cell const at = g.place_of(l, ball.centre);
    return next_of_cell(at.number, at.part, c, most, range);
  }

  COLLIDE_HD bool next_of_level(grid<S> const& g, grid_level<S> const& l, moving_sphere<S> const& ball,
                                candidate_cursor& c, std::uint32_t most, candidate_range& range) const {
    way<S> const path(g, l, ball.centre, ball.displacement);
    while (c.step < path.steps()) {
      auto const here = path.at(c.step);
      std::uint32_t const cell = l.row(here.cell[1], here.cell[2]) + (here.cell[0] & l.mask[0]);
      if (!here.is_cell || !is_occupied(cell)) {
        ++c.step;
        c.skip = 0;
        continue;
      }
      if (next_of_cell(cell, here.part, c, most, range)) return true;
    }
    return false;
  }
};

}  // namespace collide::detail
