/// \file
/// Broad phase: uniform grids of buckets. Includes the detector and everything to use it with: with nvcc the CUDA
/// spaces too.
///
/// In the terms of the original study: bucket x host = `bucket_seq`, bucket x cuda = `bucket`, and
/// bucket x cuda_shared = `bucket_shamem`.
#pragma once

#include <algorithm>

#include <collide/detail/block.hpp>
#include <collide/detail/grid.hpp>
#include <collide/detail/hits.hpp>
#include <collide/detail/sorted_spheres.hpp>
#include <collide/detail/sphere_batch.hpp>
#include <collide/detail/way.hpp>
#include <collide/detector.hpp>

namespace collide {

namespace detail {

/// Kernel body: each lane looks up the cells of some spheres; the few spheres whose cell is not empty are compacted in
/// scratch memory, and their candidates are spread evenly over all lanes.
template <class S, class NarrowPhase, class Sink>
struct bucket_query {
  static constexpr int items = 4;
  static constexpr bool still = at_rest<NarrowPhase, S>;

  tester<S, NarrowPhase, Sink> tests;
  bounding_sphere<S> const* bounds;  ///< null if there was no room for them
  grid<S> const* grids;              ///< by falling reach
  int grid_count;                    ///< 0: every sphere is tested with every triangle
  std::uint32_t const* occupied;     ///< a bit per cell: most are empty, and all bits fit into a near cache
  std::uint32_t const* ends;         ///< of the entries of cell c: ends[c] .. ends[c + 1]
  std::uint32_t const* total;        ///< number of entries
  id const* entries;
  std::size_t capacity;  ///< of entries

  /// How many spheres are listed, and how many of their lists of candidates are only begun.
  struct listing {
    std::uint32_t spheres, longer;
  };

  /// The most candidates of a sphere at a time: the block numbers those of all its spheres in 32 bits.
  template <class Block>
  static constexpr std::uint32_t longest = (1u << 31) / (Block::lanes * Block::items);

  template <class Block>
  struct scratch {
    static constexpr int size = Block::lanes * Block::items;
    id spheres[size];                       ///< spheres with candidates
    std::uint32_t first[size];              ///< their first entry
    std::uint32_t counts[size];             ///< how many they have
    std::uint32_t steps[still ? 1 : size];  ///< and, of a sphere that moves, the step of its way
    listing listed;
    std::uint32_t unplaced;  ///< how many spheres no grid serves; they are listed in `first`
    typename Block::balance_scratch balance;
    hit_buffer<Block> hits;
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
    std::uint32_t step[Items];  ///< of the way, the next
    std::uint32_t skip[Items];  ///< how many entries of its cell have been listed

    COLLIDE_HD_INLINE void load(moving_sphere_view<S> const& spheres, std::size_t first) {
      batch.load(spheres, first);
      for (int k = 0; k < Items; ++k) {
        bool const sound = valid_radius(batch.radius[k]) & finite(batch.centre(k)) & finite(batch.displacement(k));
        grid_number[k] = sound ? everywhere : nowhere;
      }
    }

    COLLIDE_HD_INLINE void place(grid<S> const& box, int g) {
      S const inverse_width = box.levels > 0 ? box.level[0].inverse_width : S(0);
      for (int k = 0; k < Items; ++k) {
        bool const inside = way<S>::enters(box.lower[0], box.upper[0], batch.x[k], batch.dx[k]) &
                            way<S>::enters(box.lower[1], box.upper[1], batch.y[k], batch.dy[k]) &
                            way<S>::enters(box.lower[2], box.upper[2], batch.z[k], batch.dz[k]);
        bool const walks = way<S>::can_walk(box.lower[0], box.upper[0], inverse_width, batch.x[k], batch.dx[k]) &
                           way<S>::can_walk(box.lower[1], box.upper[1], inverse_width, batch.y[k], batch.dy[k]) &
                           way<S>::can_walk(box.lower[2], box.upper[2], inverse_width, batch.z[k], batch.dz[k]);
        bool const served = (grid_number[k] != nowhere) & (batch.radius[k] <= box.reach) & walks;
        int const there = inside ? g : nowhere;
        grid_number[k] = served ? there : grid_number[k];
      }
    }

    COLLIDE_HD_INLINE void begin_level() {
      for (int k = 0; k < Items; ++k) step[k] = skip[k] = 0;
    }
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    constexpr int n = Block::items;
    typename Block::template per_lane<lane_state<n, still>> own;
    std::size_t const first = block.index() * Block::lanes * n;
    auto const first_of = [&](int lane) { return static_cast<id>(first) + static_cast<id>(lane * n); };
    int const usable = grid_count > 0 && *total <= capacity ? grid_count : 0;

    if (!tests.begin(block, s.hits)) return;
    block.each([&](int lane) {
      if (lane != 0) return;
      s.listed = {0, 0};
      s.unplaced = 0;
    });
    block.each([&](int lane) {
      auto& mine = own[lane];
      mine.load(tests.spheres, first + static_cast<std::size_t>(lane * n));
      for (int g = 0; g < usable; ++g) mine.place(grids[g], g);
      for (int k = 0; k < n; ++k) {
        if (mine.grid_number[k] == everywhere) s.first[block.add(s.unplaced, 1)] = first_of(lane) + static_cast<id>(k);
      }
    });
    test_unplaced(block, s);

    for (int g = 0; g < usable; ++g) {
      for (int l = 0; l < grids[g].levels; ++l) {
        grid_level<S> const& level = grids[g].level[l];
        if constexpr (!still) {
          block.each([&](int lane) { own[lane].begin_level(); });
        }
        bool more = true;
        for (std::uint32_t skip = 0; more; skip += longest<Block>) {  // once, unless a list is longer or spheres move
          block.each([&](int lane) {
            auto& mine = own[lane];
            for (int k = 0; k < n; ++k) {
              if (mine.grid_number[k] != g) continue;
              if constexpr (!still) {
                way<S> const path(grids[g], level, mine.batch.centre(k), mine.batch.displacement(k));
                list_next(block, s, path, level, first_of(lane) + static_cast<id>(k), mine.step[k], mine.skip[k]);
                continue;
              }
              std::uint32_t const cell = grids[g].cell_of(level, {mine.batch.x[k], mine.batch.y[k], mine.batch.z[k]});
              if ((occupied[cell / 32] >> cell % 32 & 1) == 0) continue;
              std::uint32_t const begin = ends[cell], size = ends[cell + 1] - begin;
              if (size <= skip) continue;
              std::uint32_t const place = block.add(s.listed.spheres, 1);
              s.spheres[place] = first_of(lane) + static_cast<id>(k);
              s.first[place] = begin + skip;
              s.counts[place] = smaller(size - skip, longest<Block>);
              if (size - skip > longest<Block>) block.add(s.listed.longer, 1);
            }
          });
          listing const listed = block.shared(s.listed);
          more = still ? listed.longer != 0 : listed.spheres != 0;
          if (listed.spheres == 0) continue;
          block.balanced(
              s.balance, s.counts, listed.spheres,
              [&](std::uint32_t i) {
                auto const ball = tests.spheres[s.spheres[i]];
                if constexpr (still) {
                  return candidates{s.spheres[i], ball, entries + s.first[i]};
                } else {
                  way<S> const path(grids[g], level, ball.centre, ball.displacement);
                  return candidates_of_place{{s.spheres[i], ball, entries + s.first[i]}, path, path.at(s.steps[i])};
                }
              },
              [&](auto const& c, std::uint32_t k) {
                if constexpr (!still) {
                  if (!c.path.meets_first(c.here, tests.mesh[c.triangles[k]])) return;
                }
                test(block, s, c.number, c.ball, c.triangles[k]);
              },
              [&] { tests.make_room(block, s.hits); });
          block.each([&](int lane) {
            if (lane == 0) s.listed = {0, 0};
          });
        }
      }
    }
    tests.flush(block, s.hits);
  }

 private:
  using ball_type = std::decay_t<decltype(std::declval<spheres_of<NarrowPhase, S> const&>()[0])>;

  /// A sphere and the triangles of a cell.
  struct candidates {
    id number;
    ball_type ball;
    id const* triangles;
  };

  /// The same, and the place on the sphere's way that the cell is.
  struct candidates_of_place : candidates {
    way<S> path;
    typename way<S>::place here;
  };

  /// Lists a sphere with the next cell on its way that is not empty, if there is one.
  template <class Block>
  COLLIDE_HD void list_next(Block& block, scratch<Block>& s, way<S> const& path, grid_level<S> const& level, id number,
                            std::uint32_t& step, std::uint32_t& skip) const {
    for (; step < path.steps(); ++step, skip = 0) {
      auto const here = path.at(step);
      if (!here.is_cell) continue;
      std::uint32_t const cell = level.row(here.cell[1], here.cell[2]) + (here.cell[0] & level.mask[0]);
      if ((occupied[cell / 32] >> cell % 32 & 1) == 0) continue;
      std::uint32_t const begin = ends[cell], size = ends[cell + 1] - begin;
      if (size <= skip) continue;
      std::uint32_t const place = block.add(s.listed.spheres, 1);
      s.spheres[place] = number;
      s.first[place] = begin + skip;
      s.counts[place] = smaller(size - skip, longest<Block>);
      s.steps[place] = step;
      skip += s.counts[place];
      return;
    }
  }

  template <class Block>
  COLLIDE_HD_INLINE void test(Block& block, scratch<Block>& s, id number, ball_type const& ball, id triangle) const {
    auto const bound = bounds != nullptr ? bounds[triangle] : bounds_of(tests.mesh[triangle]);
    sphere<S> const around = enclosing(ball);
    if (bound.reached(around.centre, around.radius)) tests.test(block, s.hits, {number, triangle}, ball);
  }

  /// Tests the spheres that are too large for every grid (or all, if there is none) with every triangle.
  template <class Block>
  COLLIDE_HD void test_unplaced(Block& block, scratch<Block>& s) const {
    std::uint32_t const unplaced = block.shared(s.unplaced);
    constexpr std::size_t stride = Block::lanes;
    for (std::uint32_t i = 0; i < unplaced; ++i) {
      auto const ball = tests.spheres[s.first[i]];
      for (std::size_t base = 0; base < tests.mesh.size(); base += stride) {
        block.each([&](int lane) {
          std::size_t const t = base + static_cast<std::size_t>(lane);
          if (t < tests.mesh.size()) test(block, s, s.first[i], ball, static_cast<id>(t));
        });
        tests.make_room(block, s.hits);
      }
    }
  }
};

}  // namespace detail

/// Broad phase: uniform grids of buckets, with cells chosen from the scene; detail/grid.hpp explains how.
/// Build O(triangles), query O(spheres + candidates). Memory per triangle and grid: 4 scalars, at most 8 entries of 4
/// bytes in the CUDA spaces and 27 on the host, and up to 16 cells of 4 bytes;
/// several grids only where radii differ by more than a factor of 4.
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
  /// One pass over the mesh: bounding spheres, extent, sizes. The grids follow as soon as a radius is known.
  template <class Space>
  void build(Space& space, bucket const& options, mesh_view<S> mesh) {
    if (!(options.cell_width >= 0)) throw error("collide: bucket: the cell width is negative or NaN");
    if (options.memory_budget != 0 && mesh.size() != mesh_.size()) {
      bounds_.release();
      release_grids();
    }
    mesh_ = mesh;
    grid_count_ = wanted_ = 0;
    radius_given_ = false;
    listed_ = swapped_ = queried_ = false;
    bool const swaps_here = swaps<Space>(options);
    if (swaps_here) boxes_.reserve(space.resource(), mesh.size());
    has_bounds_ = options.memory_budget == 0 || fixed_bytes + bounds_bytes() <= options.memory_budget;
    if (has_bounds_) bounds_.reserve(space.resource(), mesh.size());
    has_summary_ = options.memory_budget == 0 || fixed_bytes <= options.memory_budget;
    if (!has_summary_) return;
    auto* const summary = summary_.reserve(space.resource(), 1);
    detail::mesh_summary<S>::clear(space, summary);
    // where spheres and triangles can swap, bounding spheres are only made with the lists
    detail::summarise_mesh<S> const body{mesh, summary, has_bounds_ && !swaps_here ? bounds_.data() : nullptr,
                                         swaps_here ? boxes_.data() : nullptr};
    space.launch(detail::blocks_for<Space>(mesh.size(), body), body);
  }

  /// Makes a grid for spheres up to `radius`, which serves until the next build.
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
    // The first time that is faster than making lists; later only if there are many spheres.
    swapped_ = grid_count_ > 0 && swaps<Space>(options) && (!queried_ || spheres.size() / 4 >= mesh_.size());
    queried_ = true;
    if constexpr (Space::sorts_spheres) {
      if (swapped_) sorted_.sort(space, spheres);
    }
    if (!swapped_) make_lists(space, options);
  }

  /// Spheres that move always look for triangles.
  template <class Space>
  void prepare(Space& space, bucket const& options, moving_sphere_view<S> const& spheres) {
    prepare_grids(space, options, spheres);
    make_lists(space, options);
  }

  /// Puts one pass over the spheres on the space's stream.
  template <class NarrowPhase, class Space, class Sink>
  void query(Space& space, detail::spheres_of<NarrowPhase, S> const& spheres, Sink const& sink) const {
    if constexpr (Space::sorts_spheres && detail::at_rest<NarrowPhase, S>) {
      if (swapped_) {
        sorted_.query(space, detail::tester<S, NarrowPhase, Sink>{mesh_, spheres, sink});
        return;
      }
    }
    detail::bucket_query<S, NarrowPhase, Sink> const body{{mesh_, spheres, sink},
                                                          has_bounds_ ? bounds_.data() : nullptr,
                                                          grids_.data(),
                                                          grid_count_,
                                                          occupied(),
                                                          counts_.data(),
                                                          counts_.data() + cells_ + 1,
                                                          entries_.data(),
                                                          entries_.capacity()};
    space.launch(detail::blocks_for<Space>(spheres.size(), body), body);
  }

  /// Width of the finest cells in use; 0 if there is no grid.
  template <class Space>
  double cell_width(Space& space) const {
    return grid_count_ == 0 ? 0.0 : static_cast<double>(space.read(&grids_.data()->width));
  }

 private:
  static constexpr std::size_t fixed_bytes =
      sizeof(detail::mesh_summary<S>) + detail::max_grids * sizeof(detail::grid<S>) + sizeof(detail::size_histogram);

  /// How many cells a triangle may touch at most, unless a width is asked for.
  template <class Space>
  static constexpr std::size_t cells_per_triangle = std::size_t(Space::bucket_span + 1) * (Space::bucket_span + 1) *
                                                    (Space::bucket_span + 1);

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

    auto* const grids = grids_.reserve(space.resource(), detail::max_grids);
    detail::plan_grid<S> plan{summary_.data(),    grids,         {},          static_cast<S>(options.cell_width),
                              Space::bucket_span, l.entry_limit, l.table_bits};
    std::copy(reaches, reaches + count, plan.reaches);
    space.for_each(count, plan);

    if constexpr (Space::sorts_spheres) {
      if (swaps<Space>(options)) sorted_.mark(space, boxes_.data(), n, grids, l.grids, cells_);
    }
    grid_count_ = l.grids;
    wanted_ = wanted;
    listed_ = false;
    if (!swaps<Space>(options)) make_lists(space, options);
  }

  /// Enters the triangles into the cells, unless they are there.
  template <class Space>
  void make_lists(Space& space, bucket const& options) {
    if (listed_ || grid_count_ == 0) return;
    std::size_t const n = mesh_.size();
    if (swaps<Space>(options)) space.for_each(n, detail::compute_bounds<S>{mesh_, bounds_.data()});
    // counts[c + 1] becomes the begin of cell c, and once it is filled its end, which is the begin of the next
    auto* const counts = counts_.reserve(space.resource(), table_size(cells_));
    detail::grid_insertion<S> const insertion{mesh_, grids_.data(), grid_count_};
    space.fill(counts, 0, table_size(cells_) * sizeof *counts);
    space.for_each(n, detail::count_entries<S>{insertion, counts + 1, occupied()});
    space.exclusive_scan(counts + 1, cells_ + 1, scratch_);
    // only a width that was asked for leaves open how many cells a triangle touches: then the device must be asked
    std::size_t const capacity = options.cell_width > 0
                                     ? space.read(counts + cells_ + 1)
                                     : cells_per_triangle<Space> * n * static_cast<std::size_t>(grid_count_);
    entries_.reserve(space.resource(), capacity);
    space.for_each(n, detail::fill_entries<S>{insertion, counts + 1, entries_.data(), entries_.capacity()});
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
  layout plan_memory(Space& space, bucket const& options, int wanted) const {
    constexpr std::size_t id_limit = std::numeric_limits<std::uint32_t>::max();
    std::size_t const n = mesh_.size();
    std::uint32_t most_bits = 12;
    while (most_bits < 28 && (std::size_t{1} << most_bits) < 8 * n) ++most_bits;
    for (int g = wanted; g > 0; --g) {
      auto const grids = static_cast<std::size_t>(g);
      if (cells_per_triangle<Space> * n * grids > id_limit) continue;
      for (std::uint32_t bits = most_bits; bits >= 6; --bits) {
        std::size_t const cells = grids << bits;
        std::size_t const base = fixed_bytes + (has_bounds_ ? bounds_bytes() : 0) +
                                 table_size(cells) * sizeof(std::uint32_t) + space.scan_bytes(cells + 1);
        std::size_t const least = base + cells_per_triangle<Space> * n * grids * sizeof(id);
        std::size_t most_entries = std::min(512 * n + (std::size_t{1} << 20), id_limit / grids);
        if (options.memory_budget != 0) {
          if (least > options.memory_budget) continue;
          most_entries = std::min(most_entries, (options.memory_budget - base) / (grids * sizeof(id)));
        }
        return {g, bits, 0.99f * static_cast<float>(most_entries)};
      }
    }
    return {};
  }

  /// Size of `counts_`: a number per cell, one more at each end, and a bit per cell.
  static std::size_t table_size(std::size_t cells) { return cells + 2 + cells / 32; }

  std::uint32_t* occupied() const { return counts_.data() + cells_ + 2; }

  std::size_t bounds_bytes() const { return mesh_.size() * sizeof(detail::bounding_sphere<S>); }

  /// What is held for another layout would come on top of what the budget was planned for.
  void release_grids() {
    counts_.release();
    entries_.release();
    scratch_.release();
  }

  mesh_view<S> mesh_;
  buffer<detail::bounding_sphere<S>> bounds_;
  buffer<detail::mesh_summary<S>> summary_;
  buffer<detail::size_histogram> radii_;
  buffer<detail::grid<S>> grids_;
  buffer<std::uint32_t> counts_;
  buffer<id> entries_;
  buffer<unsigned char> scratch_;
  std::size_t cells_ = 0;
  int grid_count_ = 0;
  int wanted_ = 0;  ///< how many grids the spheres asked for: the budget may have allowed fewer
  S reaches_[detail::max_grids] = {};
  bool radius_given_ = false;
  bool has_bounds_ = false;
  bool has_summary_ = false;
  bool listed_ = false;   ///< the triangles are in the lists of the cells
  bool swapped_ = false;  ///< the spheres are, for this query
  bool queried_ = false;  ///< this is not the first query since the build
  buffer<detail::box<S>> boxes_;
  detail::sorted_spheres<S> sorted_;
};

}  // namespace collide
