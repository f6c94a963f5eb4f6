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
#include <collide/detail/grid/build.hpp>
#include <collide/detail/grid/grid.hpp>
#include <collide/detail/grid/grid_ref.hpp>
#include <collide/detail/grid/mesh_statistics.hpp>
#include <collide/detail/grid/plan.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/detail/query/sorted_spheres.hpp>
#include <collide/detail/query/sphere_major.hpp>
#include <collide/detector.hpp>
#if defined(COLLIDE_COMPILED)
#include <collide/compiled.hpp>
#endif

namespace collide {

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
    if (has_boxes_) boxes_.reserve(space.resource(), mesh.size());
    has_summary_ = options.memory_budget == 0 || fixed_bytes <= options.memory_budget;
    if (!has_summary_) return;
    auto* const summary = summary_.reserve(space.resource(), 1);
    detail::mesh_summary<S>::clear(space, summary);
    detail::summarise_mesh<S> const body{mesh, summary, has_boxes_ ? boxes_.data() : nullptr};
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
        sorted_.query(space, detail::tester<S, NarrowPhase, Sink>{mesh_, spheres, sink, nullptr});
        return;
      }
    }
    detail::bucket_query<S, NarrowPhase, Sink> body{{mesh_, spheres, sink, boxes()}, lookup(), 0};
    body.blocks = detail::blocks_at_a_time<Space>(space, spheres.size(), body);
    space.launch(body.blocks, body);
  }

  /// What a kernel asks for the triangles near a single sphere; valid until the next build or prepare.
  detail::bucket_lookup<S> lookup() const {
    return {{mesh_, boxes()}, grids_.data(), grid_count_,     occupied(),
            lists_.data(),    lists_total(), entries_.data(), entries_.capacity()};
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

  std::size_t boxes_bytes() const { return mesh_.size() * sizeof(detail::triangle_box<S>); }
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

#if defined(COLLIDE_COMPILED)
COLLIDE_COMPILED_ELSEWHERE(bucket, host)
#if defined(__CUDACC__) && defined(COLLIDE_COMPILED_CUDA)
COLLIDE_COMPILED_ELSEWHERE(bucket, cuda)
COLLIDE_COMPILED_ELSEWHERE(bucket, cuda_shared)
#endif
#endif

}  // namespace collide
