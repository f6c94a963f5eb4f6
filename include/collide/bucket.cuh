/// \file
/// Broad phase: uniform grids of buckets. Includes the detector and everything to use it with: with nvcc the CUDA
/// spaces too.
///
/// In the terms of the original study: bucket x host = `bucket_seq`, bucket x cuda = `bucket`, and
/// bucket x cuda_shared = `bucket_shamem`.
#pragma once

#include <algorithm>
#include <limits>

#include <collide/detail/execution/launch.hpp>
#include <collide/detail/geometry/sphere_pack.hpp>
#include <collide/detail/grid/build.hpp>
#include <collide/detail/grid/grid.hpp>
#include <collide/detail/grid/grid_ref.hpp>
#include <collide/detail/grid/mesh_statistics.hpp>
#include <collide/detail/grid/plan.hpp>
#include <collide/detail/grid/swept_cells.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/detail/query/sorted_spheres.hpp>
#include <collide/detector.hpp>

namespace collide {

namespace detail {

/// Kernel body: each lane places some spheres; the few that are inside a grid are listed in scratch memory, so that
/// lanes look up the cells of as many of them at a time as there are lanes; those whose cell is not empty are listed
/// again, and their candidates are spread evenly over all lanes.
template <class S, class NarrowPhase, class Sink>
struct bucket_query {
  static constexpr int items = 4;
  static constexpr bool still = at_rest<NarrowPhase, S>;
  /// Entries that a lane looks at together. With room for those of spheres that move, and for where these are on their
  /// ways, 48 KB of scratch memory must suffice; and less leaves more of it to the cache.
  static constexpr int ahead = still ? 3 : 2;
  template <class Block>
  static constexpr int residency = still ? 4 : 3;

  /// Whether a lane loads its first spheres before it is known how they are to be asked. Narrow phases that are not in
  /// stages have no registers left for that on CUDA.
  static constexpr bool loads_early = in_stages<NarrowPhase>::value;

  tester<S, NarrowPhase, Sink> tests;
  bucket_lookup<S> triangles;
  std::size_t blocks;  ///< that share the spheres

  /// A sphere and its first entry.
  struct alignas(8) numbered {
    id sphere;
    std::uint32_t first;
  };

  /// How many spheres are placed, how many of them in no grid, because none serves them, and how many lanes have more.
  struct placement {
    std::uint32_t placed, unplaced, unfinished;
  };

  /// How many lists of candidates there are, or would be with room for more, and how many spheres have more.
  struct listing {
    std::uint32_t lists, unfinished;
  };

  /// The most entries of a sphere at a time: the block numbers the candidates of all its spheres in 32 bits.
  template <class Block>
  static constexpr std::uint32_t longest = (1u << 30) / Block::lanes;

  template <class Block>
  struct scratch {
    static constexpr std::uint32_t room = 2 * Block::lanes * Block::items;
    id placed[room];            ///< spheres inside a grid
    std::int8_t grid_of[room];  ///< and in which
    placement found;
    numbered numbers[Block::lanes];                           ///< spheres with candidates
    std::uint32_t counts[Block::lanes];                       ///< how many they have
    std::uint32_t at[Block::lanes];                           ///< where in their cells they are
    typename way<S>::place places[still ? 1 : Block::lanes];  ///< and, of those that move, where on their ways
    listing listed;
    typename Block::balance_scratch balance;
    hit_buffer<Block, ahead> hits;
  };

  static constexpr int nowhere = -1;     ///< number of the grid of a sphere that touches nothing
  static constexpr int everywhere = -2;  ///< number of the grid of a sphere that no grid serves

  /// The spheres of a lane, and which grid serves each. Grids come by falling reach, so a sphere ends up in the
  /// tightest.
  template <int Items, bool Still>
  struct lane_state {
    sphere_batch<S, Items> batch;
    int grid_number[Items];

    COLLIDE_HD_INLINE void load(sphere_view<S> const& spheres, std::size_t first) {
      batch.load(spheres, first);
      for (int k = 0; k < Items; ++k) grid_number[k] = valid_radius(batch.radius[k]) ? everywhere : nowhere;
    }

    /// Places the spheres that grid `g` can serve. Without branches, for the CPU's vector unit.
    COLLIDE_HD_INLINE void place(grid<S> const& box, int g) {
      for (int k = 0; k < Items; ++k) {
        bool const inside = (batch.x[k] >= box.lower[0]) & (batch.x[k] <= box.upper[0]) & (batch.y[k] >= box.lower[1]) &
                            (batch.y[k] <= box.upper[1]) & (batch.z[k] >= box.lower[2]) & (batch.z[k] <= box.upper[2]);
        // a sphere that is nowhere stays there: its radius may be NaN, and comparisons with that are up to -ffast-math
        bool const served = (grid_number[k] != nowhere) & (batch.radius[k] <= box.reach);
        int const there = inside ? g : nowhere;
        grid_number[k] = served ? there : grid_number[k];
      }
    }
  };

  /// The same of spheres that move.
  template <int Items>
  struct lane_state<Items, false> {
    moving_batch<S, Items> batch;
    int grid_number[Items];

    COLLIDE_HD_INLINE void load(moving_sphere_view<S> const& spheres, std::size_t first) {
      batch.load(spheres, first);
      for (int k = 0; k < Items; ++k) {
        bool const sound = valid_radius(batch.radius[k]) && finite(batch.centre(k)) && finite(batch.displacement(k));
        grid_number[k] = sound ? everywhere : nowhere;
      }
    }

    COLLIDE_HD_INLINE void place(grid<S> const& box, int g) {
      S const inverse_width = box.levels > 0 ? box.level[0].inverse_width : S(0);
      for (int k = 0; k < Items; ++k) {
        bool const inside = way<S>::enters(box.lower[0], box.upper[0], batch.x[k], batch.dx[k]) &&
                            way<S>::enters(box.lower[1], box.upper[1], batch.y[k], batch.dy[k]) &&
                            way<S>::enters(box.lower[2], box.upper[2], batch.z[k], batch.dz[k]);
        bool const walks = way<S>::can_walk(box.lower[0], box.upper[0], inverse_width, batch.x[k], batch.dx[k]) &&
                           way<S>::can_walk(box.lower[1], box.upper[1], inverse_width, batch.y[k], batch.dy[k]) &&
                           way<S>::can_walk(box.lower[2], box.upper[2], inverse_width, batch.z[k], batch.dz[k]);
        bool const served = grid_number[k] != nowhere && batch.radius[k] <= box.reach && walks;
        int const there = inside ? g : nowhere;
        grid_number[k] = served ? there : grid_number[k];
      }
    }
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    cell_marks<S> const marks = triangles.marks();
    bool const simple = tests.spheres.one_radius() && triangles.is_simple(tests.spheres.common_radius());
    bucket_lookup<S> const near = triangles.opened();
    typename Block::template per_lane<std::size_t> next;
    typename Block::template per_lane<group<Block>> own;
    S const* const quads = quads_of<Block>();
    block.each([&](int lane) {
      next[lane] = first_of(block, lane);
      if (loads_early) load_ahead<Block>(own[lane], quads, next[lane]);
      tests.begin(s.hits, lane);
      if (lane != 0) return;
      s.found = {0, 0, 0};
      s.listed = {0, 0};
    });
    for (;;) {
      block.each([&](int lane) {
        if (simple) {
          mark_many(block, s, marks, near, next[lane], quads, own[lane]);
        } else {
          place_many<Block>(next[lane], [&](std::size_t first) { return place_own(block, s, near, first); });
        }
        if (next[lane] < tests.spheres.size()) block.add(s.found.unfinished, 1);
      });
      placement const found = block.shared(s.found);
      if (found.placed != 0) look_up(block, s, near, marks, found, simple);
      if (found.unfinished == 0) break;
      block.each([&](int lane) {
        if (lane == 0) s.found = {0, 0, 0};
        if (loads_early) load_ahead<Block>(own[lane], quads, next[lane]);
      });
    }
    tests.flush(block, s.hits, entries{near});
  }

 private:
  /// What the candidates are: entries.
  struct entries {
    bucket_lookup<S> const& of;
    std::uint32_t bits = of.bits;

    template <class Ball>
    COLLIDE_HD_INLINE bool allow(id triangle, Ball const& s) const {
      return of.template may_touch<NarrowPhase>(s, triangle);
    }
  };

  /// Lanes take spheres in turn, some in a row at a time, of which those of neighbours are next to each other: where a
  /// lane begins, and how far it goes on in each turn.
  template <class Block>
  COLLIDE_HD_INLINE std::size_t first_of(Block const& block, int lane) const {
    constexpr auto beside = static_cast<std::size_t>(Block::row_lanes);
    auto const own = static_cast<std::size_t>(lane);
    return ((own / beside * blocks + block.index()) * beside + own % beside) * Block::items;
  }
  template <class Block>
  COLLIDE_HD_INLINE std::size_t turn() const {
    return blocks * Block::lanes * Block::items;
  }

  /// How many groups a lane places at most before all look up what they have found: where lanes work together, one that
  /// finds less than others would else go on alone.
  template <class Block>
  static constexpr std::uint32_t most_groups = Block::lanes > 1 ? 12 : std::numeric_limits<std::uint32_t>::max();

  /// Places a lane's spheres, from `next` on, as long as there is room; `place(first)` lists some and says how many.
  template <class Block, class Place>
  COLLIDE_HD_INLINE void place_many(std::size_t& next, Place const& place) const {
    constexpr std::uint32_t n = Block::items, room = scratch<Block>::room / Block::lanes;
    std::uint32_t placed = 0;
    for (std::uint32_t k = 0; k < most_groups<Block> && next < tests.spheres.size() && placed + n <= room; ++k) {
      placed += place(next);
      next += turn<Block>();
    }
  }

  struct nothing {};
  /// Spheres that a lane loads before it needs them, if they rest.
  template <class Block>
  using group = std::conditional_t<still, sphere_batch<S, Block::items>, nothing>;

  /// The centres, where whole groups of them can be loaded at once; else null.
  template <class Block>
  COLLIDE_HD_INLINE S const* quads_of() const {
    if constexpr (still) {
      return tests.spheres.size() < Block::items ? nullptr : group<Block>::quads_of(tests.spheres);
    } else {
      return nullptr;
    }
  }

  /// Loads the group from `first` on; if not all of it is there, some others: ptxas 13.0 keeps in memory what it loads
  /// under a condition.
  template <class Block>
  COLLIDE_HD_INLINE void load_ahead([[maybe_unused]] group<Block>& own, [[maybe_unused]] S const* quads,
                                    [[maybe_unused]] std::size_t first) const {
    if constexpr (still) {
      if (quads != nullptr) own.load_quads(quads, first + Block::items <= tests.spheres.size() ? first : 0);
    }
  }

  /// The same where most spheres are asked one bit. Where whole groups can be loaded at once, the next one is on its
  /// way while a group is marked. `own` is the first one if `loads_early`.
  template <class Block>
  COLLIDE_HD_INLINE void mark_many(Block& block, scratch<Block>& s, cell_marks<S> const& marks,
                                   bucket_lookup<S> const& near, std::size_t& next, [[maybe_unused]] S const* quads,
                                   [[maybe_unused]] group<Block>& own) const {
    if constexpr (still) {
      auto const mark = [&](typename cell_marks<S>::template places<Block::items> const& places, std::size_t first) {
        bool marked[Block::items];
        marks.mark(places, marked);
        return list_marked(block, s, marked, first);
      };
      auto const load_and_mark = [&](std::size_t first) {
        group<Block> some;
        some.load(tests.spheres, first);
        return mark(marks.places_of(some.x, some.y, some.z), first);
      };
      if (quads == nullptr) {
        place_many<Block>(next, load_and_mark);
        return;
      }
      if (!loads_early) load_ahead<Block>(own, quads, next);
      place_many<Block>(next, [&](std::size_t first) {
        if (first + Block::items > tests.spheres.size()) return load_and_mark(first);
        auto const places = marks.places_of(own.x, own.y, own.z);
        load_ahead<Block>(own, quads, first + turn<Block>());
        return mark(places, first);
      });
    } else {
      place_many<Block>(next, [&](std::size_t first) {
        if (first + Block::items > tests.spheres.size()) return place_own(block, s, near, first);
        moving_batch<S, Block::items> own;
        own.load(tests.spheres, first);
        bool marked[Block::items];
        bool const known = marks.mark_ways(own, marked);
        return known ? list_marked(block, s, marked, first) : place_own(block, s, near, first);
      });
    }
  }

  /// Lists those of a lane's spheres, from `first` on, that are marked; returns how many.
  template <class Block>
  COLLIDE_HD_INLINE std::uint32_t list_marked(Block& block, scratch<Block>& s, bool const (&marked)[Block::items],
                                              std::size_t first) const {
    constexpr int n = Block::items;
    std::uint32_t placed = 0;
    for (int k = 0; k < n; ++k) placed += marked[k];
    if (placed == 0) return 0;
    std::uint32_t place = block.add(s.found.placed, placed);
    for (int k = 0; k < n; ++k) {
      if (!marked[k]) continue;
      s.placed[place] = static_cast<id>(first) + static_cast<id>(k);
      s.grid_of[place++] = 0;
    }
    return placed;
  }

  /// Lists those of a lane's spheres from `first` on that are inside a grid or that no grid serves; returns how many.
  template <class Block>
  COLLIDE_HD_INLINE std::uint32_t place_own(Block& block, scratch<Block>& s, bucket_lookup<S> const& near,
                                            std::size_t first) const {
    constexpr int n = Block::items;
    lane_state<n, still> own;
    own.load(tests.spheres, first);
    for (int g = 0; g < near.grid_count; ++g) own.place(near.grids[g], g);
    std::uint32_t placed = 0, unplaced = 0;
    for (int k = 0; k < n; ++k) {
      if constexpr (!still) {
        int const g = own.grid_number[k];
        if (g >= 0 && near.empty_in(near.grids[g], own.batch.ball(k))) own.grid_number[k] = nowhere;
      }
      placed += own.grid_number[k] != nowhere;
      unplaced += own.grid_number[k] == everywhere;
    }
    if (placed == 0) return 0;
    if (unplaced != 0) block.add(s.found.unplaced, unplaced);
    std::uint32_t place = block.add(s.found.placed, placed);
    for (int k = 0; k < n; ++k) {
      if (own.grid_number[k] == nowhere) continue;
      s.placed[place] = static_cast<id>(first) + static_cast<id>(k);
      s.grid_of[place++] = static_cast<std::int8_t>(own.grid_number[k]);
    }
    return placed;
  }

  /// Tests the spheres that are listed; `one_level` says that this is all that the grids have.
  template <class Block>
  COLLIDE_HD_INLINE void look_up(Block& block, scratch<Block>& s, bucket_lookup<S> const& near,
                                 cell_marks<S> const& marks, placement const& found, bool one_level) const {
    int const usable = near.grid_count;
    // the spheres of one level of one grid after the other, in the end those that no grid serves
    for (int g = 0; g <= usable; ++g) {
      bool const all = g == usable;
      if (all && found.unplaced == 0) break;
      for (int l = 0; l < (all || one_level ? 1 : near.grids[g].levels); ++l) {
        cells const here{all ? nullptr : &near.grids[g], all ? nullptr : &near.grids[g].level[l]};
        for (std::uint32_t base = 0; base < found.placed; base += Block::lanes) {
          typename Block::template per_lane<cursor> at;
          bool more = false;
          do {  // once, unless a list is very long, or spheres that move have more lists than there are lanes
            block.each([&](int lane) {
              if (!more) at[lane] = {0, 0};
              std::uint32_t const i = base + static_cast<std::uint32_t>(lane);
              if (i >= found.placed || s.grid_of[i] != (all ? everywhere : g)) return;
              bool const all_listed = still && one_level
                                          ? list_marked_cell(block, s, near, marks, s.placed[i], at[lane])
                                          : list_all(block, s, near, here, s.placed[i], at[lane]);
              if (!all_listed) block.add(s.listed.unfinished, 1);
            });
            listing const listed = block.shared(s.listed);
            more = listed.unfinished != 0;
            if (listed.lists == 0) continue;
            test_listed(block, s, near, here, smaller<std::uint32_t>(listed.lists, Block::lanes));
            block.each([&](int lane) {
              if (lane == 0) s.listed = {0, 0};
            });
          } while (more);
        }
      }
    }
  }

  /// The cells of a level of a grid; without a grid, one cell that lists all triangles.
  struct cells {
    grid<S> const* of;
    grid_level<S> const* level;
  };

  /// How far a sphere has come: steps of its way, and entries of its cell.
  struct cursor {
    std::uint32_t step, skip;
  };

  /// Makes the candidates of the `n` lists: their entries, spread evenly over the lanes.
  template <class Block>
  COLLIDE_HD_INLINE void test_listed(Block& block, scratch<Block>& s, bucket_lookup<S> const& near, cells const& here,
                                     std::uint32_t n) const {
    struct candidates {
      numbered of;
      std::uint32_t list;
    };
    bool const all = here.of == nullptr;
    block.template balanced<ahead>(
        s.balance, s.counts, n,
        [&](std::uint32_t i) {
          return candidates{s.numbers[i], i};
        },
        [&](candidates const& c, std::uint32_t k) {
          return all ? cell_entry{c.of.first + k, cell_part::whole} : near.entries[c.of.first + k];
        },
        [&](candidates const& c, cell_entry const& e) { return cell_part::meets(e.part, s.at[c.list]); },
        [&](candidates const& c, cell_entry const& e) {
          if constexpr (!still) {
            if (!all && !counts_in(near, here, s.places[c.list], e)) return;
          }
          if constexpr (Block::lanes > 1) {
            tests.test(block, s.hits, {c.of.sphere, e.number});
          } else {
            auto const ball = tests.spheres[c.of.sphere];
            near.each_near(enclosing(ball), e, [&](id triangle) {
              tests.test(block, s.hits, {c.of.sphere, triangle}, ball);
            });
          }
        },
        [&] { tests.make_room(block, s.hits, entries{near}); });
  }

  /// True if an entry counts in this cell of a way, and not in another.
  COLLIDE_HD_INLINE bool counts_in(bucket_lookup<S> const& near, cells const& here, typename way<S>::place const& place,
                                   cell_entry const& e) const {
    if (place.later != way<S>::place::unknown) return !cell_part::begins_before(e.part, place.later);
    return place.is_only || place.is_first_of(here.of->range_of(*here.level, near.box_of(e)));
  }

  /// Lists a sphere with the entries of its cells that are not empty, as far as there is room. True if that was all.
  template <class Block>
  COLLIDE_HD_INLINE bool list_all(Block& block, scratch<Block>& s, bucket_lookup<S> const& near, cells const& here,
                                  id number, cursor& at) const {
    auto const ball = tests.spheres[number];
    if (here.of == nullptr) {
      return list(block, s, number, {near.entry_count(), near.entry_count()}, cell_part::anywhere, at);
    } else if constexpr (still) {
      covered_cell const cell = here.of->place_of(*here.level, ball.centre);
      return list(block, s, number, near.lists[cell.number], cell.part, at);
    } else {
      way<S> const path(*here.of, *here.level, ball.centre, ball.displacement);
      for (; at.step < path.steps(); ++at.step, at.skip = 0) {
        auto const place = path.at(at.step);
        std::uint32_t const cell =
            here.level->row(place.cell[1], place.cell[2]) + (place.cell[0] & here.level->mask[0]);
        if (!place.is_cell || !near.is_occupied(cell)) continue;
        if (!list(block, s, number, near.lists[cell], place.part, at, &place)) return false;
      }
      return true;
    }
  }

  /// The same of a sphere that was marked: from what is known of its cell, without asking the grid.
  template <class Block>
  COLLIDE_HD_INLINE bool list_marked_cell(Block& block, scratch<Block>& s, bucket_lookup<S> const& near,
                                          cell_marks<S> const& marks, id number, cursor& at) const {
    covered_cell const cell = marks.place_of(tests.spheres[number].centre);
    return list(block, s, number, near.lists[cell.number], cell.part, at);
  }

  /// Lists a sphere with the entries of a cell from at.skip on. False if there was no room for all of them.
  template <class Block>
  COLLIDE_HD_INLINE bool list(Block& block, scratch<Block>& s, id number, cell_list cell, std::uint32_t inside,
                              cursor& at, typename way<S>::place const* place = nullptr) const {
    std::uint32_t const left = cell.count - at.skip, listed = smaller(left, longest<Block>);
    if (left == 0) return true;
    std::uint32_t const slot = block.add(s.listed.lists, 1);
    if (slot >= Block::lanes) return false;
    s.numbers[slot] = {number, cell.end - left};
    s.counts[slot] = listed;
    s.at[slot] = inside;
    if constexpr (!still) {
      if (place != nullptr) s.places[slot] = *place;
    }
    at.skip += listed;
    return left == listed;
  }
};

}  // namespace detail

/// Broad phase: uniform grids of buckets, with cells chosen from the scene; detail/grid/grid.hpp explains how.
/// Build O(triangles), query O(spheres + candidates). Memory per triangle and grid: 8 scalars, at most 27 entries of 8
/// bytes in the CUDA spaces and 8 on the host, and up to 8 cells of 8 bytes; several grids only where radii differ by
/// more than a factor of 4. The host sorts the spheres instead where there are many (detail/query/sorted_spheres.hpp):
/// that takes O(triangles + spheres) for a query, 8 scalars per triangle, 4 bytes per cell, and about 12 scalars for
/// each sphere in a cell with triangles, 19 if it moves; no entries.
struct bucket {
  /// Width of the finest cells; 0 lets the library choose. The study's was 4 R. Triangles that would touch too many
  /// such cells go to levels of wider ones.
  double cell_width = 0;

  /// Bytes that the grids may take at most; 0 is no limit. Where the budget does not suffice for a grid, the spheres
  /// are tested with every triangle: slower, with the same result.
  std::size_t memory_budget = 0;

  template <class S>
  class index;
};

/// The buckets of a mesh.
template <class S>
class bucket::index {
 public:
  /// One pass over the mesh: boxes, extent, sizes. The grids follow as soon as a radius is known.
  template <class Space>
  void build(Space& space, bucket const& options, mesh_view<S> mesh) {
    if (!(options.cell_width >= 0)) throw error("collide: bucket: the cell width is negative or NaN");
    if (options.memory_budget != 0 && mesh.size() != mesh_.size()) {
      boxes_.release();
      release_grids();
    }
    mesh_ = mesh;
    grid_count_ = wanted_ = 0;
    radius_given_ = false;
    listed_ = swapped_ = queried_ = false;
    has_boxes_ = options.memory_budget == 0 || fixed_bytes + boxes_bytes() <= options.memory_budget;
    if (has_boxes_) boxes_.reserve(space.resource(), mesh.size() + 1);
    has_summary_ = options.memory_budget == 0 || fixed_bytes <= options.memory_budget;
    if (!has_summary_) return;
    auto* const summary = summary_.reserve(space.resource(), 1);
    detail::mesh_summary<S>::clear(space, summary);
    detail::summarise_mesh<S> const body{mesh, summary, has_boxes_ ? boxes_.data() : nullptr,
                                         has_boxes_ && Space::pairs_triangles};
    space.launch(detail::blocks_for<Space>(mesh.size(), body), body);
  }

  /// Makes a grid for spheres up to `radius`, which serves until the next build, or until many spheres that move want
  /// another.
  template <class Space>
  void prepare(Space& space, bucket const& options, S radius) {
    radius_given_ = true;
    if (has_summary_ && detail::valid_radius(radius) && detail::finite(radius)) make_grids(space, options, &radius, 1);
  }

  /// Makes the grids that the spheres need, unless they are there. Waits for the host to see the radii where they
  /// differ.
  template <class Space>
  void prepare(Space& space, bucket const& options, sphere_view<S> const& spheres) {
    prepare_grids(space, options, spheres);
    // The first time that is faster than making lists; later only if there are many spheres (docs/performance.md).
    swapped_ = grid_count_ > 0 && swaps<Space>(options) && spheres.size() <= detail::sorted_spheres<S>::most &&
               (!queried_ || spheres.size() / 3 >= mesh_.size() / 2);
    queried_ = true;
    if constexpr (Space::sorts_spheres) {
      if (swapped_) sorted_.sort(space, spheres);
    }
    if (!swapped_) make_lists(space, options);
  }

  /// Spheres that move are sorted, too, if there are many, of one radius, and none moves far; else they look for
  /// triangles along their ways.
  template <class Space>
  void prepare(Space& space, bucket const& options, moving_sphere_view<S> const& spheres) {
    swapped_ = false;
    if constexpr (Space::sorts_spheres) {
      if (swaps<Space>(options) && has_summary_ && spheres.one_radius() && spheres.size() / 4 >= mesh_.size() &&
          spheres.size() <= detail::sorted_spheres<S>::most) {
        S const reach = sorted_.reach_of(space, spheres);
        if (detail::finite(reach) && reach <= 2 * spheres.common_radius()) {
          S const wider = reach + reach / 16;  // so that a bit more next time fits too
          bool const kept = wanted_ == 1 && reach <= reaches_[0] && reaches_[0] <= 2 * reach;
          if (!kept) {
            make_grids(space, options, &wider, 1);
            radius_given_ = false;  // the grid of that radius is no more
          }
          swapped_ = grid_count_ > 0;
          if (swapped_) {
            sorted_.sort(space, detail::balls_around<S>{spheres, reach});
            return;
          }
        }
      }
    }
    prepare_grids(space, options, spheres);
    make_lists(space, options);
  }

  /// Puts one pass over the spheres on the space's stream.
  template <class NarrowPhase, class Space, class Sink>
  void query(Space& space, detail::spheres_of<NarrowPhase, S> const& spheres, Sink const& sink) const {
    if constexpr (Space::sorts_spheres) {
      if (swapped_) {
        sorted_.query(space, detail::tester<S, NarrowPhase, Sink>{mesh_, spheres, sink});
        return;
      }
    }
    detail::bucket_query<S, NarrowPhase, Sink> body{{mesh_, spheres, sink}, lookup(), 0};
    body.blocks = detail::blocks_at_a_time<Space>(space, spheres.size(), body);
    space.launch(body.blocks, body);
  }

  /// What a kernel asks for the triangles near a single sphere; valid until the next build or prepare.
  detail::bucket_lookup<S> lookup() const {
    return {{mesh_, boxes(), 0}, grids_.data(), grid_count_,     occupied(),
            lists_.data(),       lists_total(), entries_.data(), entries_.capacity()};
  }

  /// Width of the finest cells in use; 0 if there is no grid.
  template <class Space>
  double cell_width(Space& space) const {
    return grid_count_ == 0 ? 0.0 : static_cast<double>(space.read(&grids_.data()->width));
  }

 private:
  static constexpr std::size_t fixed_bytes =
      sizeof(detail::mesh_summary<S>) + detail::max_grids * sizeof(detail::grid<S>) + sizeof(detail::size_histogram);

  /// How many cells a triangle may touch at most, on an axis and in all, unless a width is asked for.
  template <class Space>
  static constexpr std::size_t cells_per_axis = std::size_t(Space::bucket_span) +
                                                (Space::bucket_span > int(Space::bucket_span) ? 2 : 1);
  template <class Space>
  static constexpr std::size_t cells_per_triangle = cells_per_axis<Space>* cells_per_axis<Space>* cells_per_axis<Space>;

  template <class Space>
  void prepare_grids(Space& space, bucket const& options, sphere_view<S> const& spheres) {
    if (radius_given_ || !has_summary_) return;
    S reaches[detail::max_grids];
    int const n =
        spheres.one_radius() ? reach_of(spheres.common_radius(), reaches) : reaches_of(space, spheres, reaches);
    if (n == 0 || (n == wanted_ && std::equal(reaches, reaches + n, reaches_))) return;
    make_grids(space, options, reaches, n);
  }

  /// The grid of one radius: the one that is there if it is not much too wide.
  int reach_of(S radius, S* reaches) const {
    if (!detail::valid_radius(radius) || !detail::finite(radius)) return 0;
    bool const kept = wanted_ == 1 && radius <= reaches_[0] && reaches_[0] <= 4 * radius;
    reaches[0] = kept ? reaches_[0] : radius;
    return 1;
  }

  /// The grids of many radii: reaches a factor of 4 or more apart, only where there are spheres.
  template <class Space>
  int reaches_of(Space& space, sphere_view<S> const& spheres, S* reaches) {
    auto* const radii = radii_.reserve(space.resource(), 1);
    detail::size_histogram::clear(space, radii);
    detail::summarise_radii<S> const body{spheres, radii};
    space.launch(detail::blocks_for<Space>(spheres.size(), body), body);
    detail::size_histogram const seen = space.read(radii);
    if (seen.empty()) return 0;
    constexpr int bins_per_factor_4 = 8;
    int n = 0;
    for (int b = seen.last(); b >= seen.first() && n < detail::max_grids; b -= bins_per_factor_4) {
      while (seen.counts[b] == 0) --b;
      float const end = detail::bin_end(static_cast<std::uint32_t>(b));
      reaches[n++] = static_cast<S>(std::min(end, std::numeric_limits<float>::max()));
    }
    return n;
  }

  template <class Space>
  void make_grids(Space& space, bucket const& options, S const* reaches, int wanted) {
    grid_count_ = wanted_ = 0;  // until all is done: an exception leaves no half-made grid behind
    std::size_t const n = mesh_.size();
    layout const l = plan_memory(space, options, wanted);
    std::copy(reaches, reaches + wanted, reaches_);
    if (l.grids == 0) {
      wanted_ = wanted;
      return;
    }
    auto const count = static_cast<std::size_t>(l.grids);
    if (options.memory_budget != 0 && cells_ != count << l.table_bits) release_grids();
    cells_ = count << l.table_bits;
    table_bits_ = l.table_bits;

    bool const swapping = swaps<Space>(options);
    auto* const grids = grids_.reserve(space.resource(), detail::max_grids);
    detail::plan_grid<S> plan{summary_.data(),
                              grids,
                              {},
                              static_cast<S>(options.cell_width),
                              static_cast<S>(Space::bucket_span),
                              l.entry_limit,
                              l.table_bits,
                              has_boxes_ && Space::pairs_triangles,
                              l.grids,
                              swapping ? nullptr : lists_.reserve(space.resource(), table_size(cells_)),
                              swapping ? 0 : cells_ + 1};
    std::copy(reaches, reaches + count, plan.reaches);
    space.launch(plan.template blocks<typename Space::template block<detail::plan_grid<S>>>(), plan);

    if constexpr (Space::sorts_spheres) {
      if (swapping) sorted_.mark(space, boxes_.data(), n, grids, l.grids, l.table_bits);
    }
    grid_count_ = l.grids;
    wanted_ = wanted;
    listed_ = false;
    lists_empty_ = !swapping;
    if (!swapping) make_lists(space, options);
  }

  /// Enters the triangles into the cells, unless they are there.
  template <class Space>
  void make_lists(Space& space, bucket const& options) {
    std::size_t const n = mesh_.size();
    if (listed_ || grid_count_ == 0) return;
    auto* const lists = lists_.reserve(space.resource(), table_size(cells_));
    constexpr int parts = Space::insertion_parts;
    detail::grid_insertion<S, parts> const insertion{mesh_, boxes(), grids_.data(), grid_count_};
    if (!lists_empty_) space.fill(lists, 0, (cells_ + 1) * sizeof *lists);
    lists_empty_ = false;
    space.for_each(insertion.size(), detail::count_entries<S, parts>{insertion, lists});
    detail::allocate_entries<S> const allocation{grids_.data(), table_bits_, cells_,
                                                 lists,         occupied(),  &lists[cells_].count};
    space.launch(detail::blocks_for<Space>(cells_, allocation), allocation);
    // only a width that was asked for leaves open how many entries there are: then the device must be asked
    std::size_t const capacity = options.cell_width > 0
                                     ? space.read(lists_total())
                                     : cells_per_triangle<Space> * n * static_cast<std::size_t>(grid_count_);
    entries_.reserve(space.resource(), capacity);
    space.for_each(insertion.size(),
                   detail::fill_entries<S, parts>{insertion, lists, entries_.data(), entries_.capacity()});
    listed_ = true;
  }

  /// True if spheres can be sorted into the cells instead of triangles: what that takes is not part of a budget.
  template <class Space>
  static bool swaps(bucket const& options) {
    return Space::sorts_spheres && options.memory_budget == 0;
  }

  struct layout {
    int grids = 0;
    std::uint32_t table_bits = 0;
    float entry_limit = 0;  ///< per grid
  };

  /// How many grids with how many cells the budget allows; the more grids the better, then the more cells.
  template <class Space>
  layout plan_memory(Space const&, bucket const& options, int wanted) const {
    constexpr std::size_t id_limit = std::numeric_limits<std::uint32_t>::max();
    std::size_t const n = mesh_.size();
    std::uint32_t most_bits = 12;
    while (most_bits < 28 && (std::size_t{1} << most_bits) < 4 * n) ++most_bits;
    for (int g = wanted; g > 0; --g) {
      auto const grids = static_cast<std::size_t>(g);
      if (cells_per_triangle<Space> * n * grids > id_limit) continue;
      for (std::uint32_t bits = most_bits; bits >= 6; --bits) {
        std::size_t const cells = grids << bits;
        std::size_t const base =
            fixed_bytes + (has_boxes_ ? boxes_bytes() : 0) + table_size(cells) * sizeof(detail::cell_list);
        std::size_t const least = base + cells_per_triangle<Space> * n * grids * sizeof(detail::cell_entry);
        std::size_t most_entries = std::min(512 * n + (std::size_t{1} << 20), id_limit / grids);
        if (options.memory_budget != 0) {
          if (least > options.memory_budget) continue;
          most_entries = std::min(most_entries, (options.memory_budget - base) / (grids * sizeof(detail::cell_entry)));
        }
        return {g, bits, 0.99f * static_cast<float>(most_entries)};
      }
    }
    return {};
  }

  /// Size of `lists_`: a list per cell, the number of all entries, and a bit per cell.
  static std::size_t table_size(std::size_t cells) { return cells + 1 + cells / 64; }

  std::uint32_t const* lists_total() const { return &lists_.data()[cells_].count; }
  std::uint8_t* occupied() const { return reinterpret_cast<std::uint8_t*>(lists_.data() + cells_ + 1); }

  std::size_t boxes_bytes() const { return (mesh_.size() + 1) * sizeof(detail::triangle_box<S>); }
  detail::triangle_box<S> const* boxes() const { return has_boxes_ ? boxes_.data() : nullptr; }

  /// What is held for another layout would come on top of what the budget was planned for.
  void release_grids() {
    lists_.release();
    entries_.release();
  }

  mesh_view<S> mesh_;
  buffer<detail::triangle_box<S>> boxes_;
  buffer<detail::mesh_summary<S>> summary_;
  buffer<detail::size_histogram> radii_;
  buffer<detail::grid<S>> grids_;
  buffer<detail::cell_list> lists_;
  buffer<detail::cell_entry> entries_;
  std::size_t cells_ = 0;
  std::uint32_t table_bits_ = 0;
  int grid_count_ = 0;
  int wanted_ = 0;  ///< how many grids the spheres asked for: the budget may have allowed fewer
  S reaches_[detail::max_grids] = {};
  bool radius_given_ = false;
  bool has_boxes_ = false;  ///< there was room for them
  bool has_summary_ = false;
  bool lists_empty_ = false;  ///< of the cells
  bool swapped_ = false;      ///< the spheres are, for this query
  bool listed_ = false;       ///< the triangles are in the lists of the cells
  bool queried_ = false;      ///< this is not the first query since the build
  detail::sorted_spheres<S> sorted_;
};

}  // namespace collide
