/// \file
/// Spheres that look into cells: the grids of a mesh are planned for spheres, and filled with its triangles.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/bucket/measure_groups.hpp>
#include <collide/broad/detail/bucket/sphere_major.hpp>
#include <collide/broad/detail/grid/cell_lists.hpp>
#include <collide/broad/detail/grid/grid.hpp>
#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/broad/detail/grid/memory_plan.hpp>
#include <collide/broad/detail/grid/mesh_statistics.hpp>
#include <collide/broad/detail/grid/plan.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/spaces/detail/block.hpp>
#include <collide/spaces/detail/tuning.hpp>

namespace collide::detail {

/// Measures of a mesh. The memory budget may have no room for them: then there are no grids, or no boxes.
template <class S>
struct mesh_measures {
  buffer<mesh_statistics<S>> statistics;
  buffer<triangle_aabb<S>> box_memory;
  bool has_boxes = false;  ///< of this mesh

  triangle_aabb<S> const* boxes() const { return has_boxes ? box_memory.data() : nullptr; }

  /// The statistics of no triangles.
  template <class Space>
  mesh_statistics<S>* clear(Space& space) {
    auto* const cleared = statistics.reserve(space.resource(), 1);
    mesh_statistics<S>::clear(space, cleared);
    return cleared;
  }
};

/// The grids that spheres ask for.
template <class S>
struct wanted_grids {
  S reach = 0;               ///< of the only one; negative: as the radii of the spheres need it
  int max_count = 0;         ///< how many there may be
  bool whole_boxes = false;  ///< spheres that move look for triangles along their paths
  S given = -1;              ///< how far the first of several reaches, if not as far as the radii need

  /// True if the radii of the spheres tell how far they reach.
  bool by_radii() const { return reach < 0; }

  /// True if these do for spheres that ask for `other`.
  bool serve(wanted_grids const& other) const {
    return reach == other.reach && max_count >= other.max_count && whole_boxes == other.whole_boxes &&
           given == other.given;
  }
};

/// The radii of spheres, and the reaches of grids that follow from them.
template <class S>
struct measured_radii {
  size_histogram radii;
  grid_reaches<S> reaches;
};

template <class S>
struct grid_set {
  buffer<grid<S>> memory;
  int count = 0;                  ///< as many as were asked for, or as the budget allows; the last may not be in use
  wanted_grids<S> asked;          ///< what they were made for
  std::size_t spheres = 0;        ///< how many they were made for
  bool are_filled = false;        ///< the triangles are entered into their cells
  bool const* are_new = nullptr;  ///< where a device writes if they must be, as it has made them anew; null: they must
  std::size_t cells = 0;          ///< of all grids
  std::size_t entry_limit = 0;    ///< of all cells
  std::uint32_t table_bits = 0;   ///< log2 of the number of cells per grid

  /// Forgets the grids.
  void clear() {
    count = asked.max_count = 0;
    are_filled = false;
    are_new = nullptr;
  }

  /// The radius of a grid for spheres of one radius: that of the one that is there if it is at most `max_ratio` times
  /// as wide, else `wider`.
  S reach_for(S radius, S max_ratio, S wider) const {
    bool const serves = asked.max_count == 1 && radius <= asked.reach && asked.reach <= max_ratio * radius;
    return serves ? asked.reach : wider;
  }
};

/// The width of cells and the bytes of memory that grids are held to, as `bucket` has them.
struct grid_limits {
  double cell_width = 0;
  std::size_t memory_budget = 0;
};

/// The index of a mesh for spheres that look into cells. Its grids are also those that spheres are sorted into.
template <class S>
class cell_index {
 public:
  /// Forgets the mesh that was there.
  void start(mesh_view<S> const& mesh, grid_limits const& limits) {
    limits_ = limits;
    if (limits.memory_budget != 0 && mesh.size() != mesh_.size()) {
      measures_.box_memory.release();
      lists_.release();
    }
    mesh_ = mesh;
    measures_.has_boxes = false;
    forget_grids();
  }

  /// Measures the mesh: extent, sizes, and boxes, as far as the budget allows.
  template <class Space>
  void measure(Space& space) {
    auto const affords = [&](std::size_t bytes) {
      return limits_.memory_budget == 0 || bytes <= limits_.memory_budget;
    };
    if constexpr (keeps_boxes<Space>) {
      if (affords(fixed_bytes + mesh_.size() * sizeof(triangle_aabb<S>))) {
        measures_.box_memory.reserve(space.resource(), mesh_.size());
        measures_.has_boxes = true;
        forget_grids();
      } else {
        measures_.box_memory.release();
      }
    }
    if (!affords(fixed_bytes)) return measures_.statistics.release();
    auto* const statistics = measures_.clear(space);
    compute_mesh_statistics<S> const kernel{mesh_, statistics, measures_.box_memory.data()};
    space.launch(grid_size<Space>(mesh_.size(), kernel), kernel);
  }

  /// Empty statistics, for the caller to fill in place of `measure`.
  template <class Space>
  mesh_statistics<S>* clear_statistics(Space& space) {
    return measures_.clear(space);
  }

  /// For at most this many triangles the lists of cells get memory for the largest possible number of entries; for
  /// more, or cells of a given width, the host reads the numbers back first.
  static constexpr std::size_t max_without_readback = std::size_t{1} << 18;

  /// False if the budget has no room for statistics, and so for grids.
  bool is_measured() const { return measures_.statistics.data() != nullptr; }
  grid_set<S> const& grids() const { return grids_; }
  bucket_ref<S> const& ref() const { return ref_; }

  /// How many triangles spheres find in their cells that may be near them, in the mean of every sixteenth sphere: on
  /// the host, after `fill`.
  template <class Spheres>
  float mean_candidates(Spheres const& spheres) const {
    bucket_ref<S> const near = ref_.opened();
    std::size_t asked = 0, found = 0;
    for (std::size_t i = 0; i < spheres.size(); i += 16, ++asked) {
      auto const s = spheres[i];
      candidate_range range;
      for (candidate_cursor at = near.begin(s); near.next(s, at, no_id, range);) {
        for (std::uint32_t k = 0; k < range.count; ++k) found += range.passes_coverage(range.at(k));
      }
    }
    return asked == 0 ? 0.f : static_cast<float>(found) / static_cast<float>(asked);
  }

  /// The end of the entries' memory, if the host has not asked how many there are: then about half of it is free.
  spare_pairs spare() const {
    static_assert(sizeof(cell_item) == sizeof(pair), "collide: pairs are written where entries could be");
    if (!grids_.are_filled || waits_for_sizes()) return {};
    return {reinterpret_cast<pair*>(const_cast<cell_item*>(ref_.entries)), ref_.total, ref_.capacity};
  }

  /// How many grids there may be for spheres of many radii.
  template <class Space>
  int max_grid_count(std::size_t spheres) const {
    if (bucket_tuning<Space>::bins_spheres) return max_grids;
    if (serves_steps<Space> || spheres <= fewest_of_grid()) return 1;
    int const max_count = mesh_.size() > max_without_readback ? max_grids : grids_without_readback;
    return static_cast<int>(min<std::size_t>(1 + spheres / fewest_of_grid(), static_cast<std::size_t>(max_count)));
  }

  /// Makes grids, as many as the budget allows, for these spheres, of which `all` are to come; `anew` if those that are
  /// there do not serve. Where radii tell how far they reach a device sees itself whether those that are there do. The
  /// plan samples the triangles in the order of `mesh`, if there is one. Calls mark(grids, count, table_bits) for new
  /// ones.
  template <class Space, class Spheres, class Mark>
  void make_grids(Space& space, wanted_grids<S> const& wanted, bool anew, Spheres const& spheres, std::size_t all,
                  mesh_view<S> const* mesh, Mark const& mark) {
    bool const waits = bucket_tuning<Space>::bins_spheres || waits_for_sizes();
    anew = anew || !(waits || grids_.are_filled);
    int max_count = wanted.max_count;
    grid_reaches<S> const* reaches = nullptr;
    if (wanted.by_radii()) {
      reaches = choose_reaches(space, spheres, wanted, anew);
      if (waits) {
        grid_reaches<S> const seen = space.read(reaches);
        if (!seen.are_new) return;
        anew = true;
        max_count = seen.count;
      }
    }
    if (anew) {
      forget_grids();  // until all is done: an exception leaves no half-made grid behind
      plan_memory(space, max_count, max_count > 1 && !waits, bucket_tuning<Space>::bins_spheres ? all : spheres.size());
    }
    grids_.are_filled = false;
    grids_.are_new = reaches == nullptr || waits ? nullptr : &reaches->are_new;
    if (grids_.count != 0) {
      plan_cells(space, wanted, reaches, spheres, static_cast<float>(all), mesh);
      mark(grids_.memory.data(), grids_.count, grids_.table_bits);
    }
    grids_.asked = wanted;
    grids_.spheres = all;
  }

  /// Enters the triangles into the cells, unless they are there, or there are no grids.
  template <class Space>
  void fill(Space& space) {
    if (grids_.count == 0 || grids_.are_filled) return;
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (limits_.memory_budget == 0 && !measures_.has_boxes) {
        compute_boxes<S>::run(space, mesh_, measures_.box_memory);
        measures_.has_boxes = true;
      }
    }
    bool const waits = waits_for_sizes() || (bucket_tuning<Space>::bins_spheres && grids_.count > 1);
    auto const* const boxes = measures_.boxes();
    auto const* const grids = grids_.memory.data();
    lists_.enter(space, mesh_, boxes, {grids, grids_.count, grids_.table_bits, grids_.cells, grids_.are_new},
                 grids_.entry_limit, waits);
    ref_ = {{mesh_, boxes}, grids,          grids_.count,     lists_.occupied(),
            lists_.data(),  lists_.total(), lists_.entries(), lists_.capacity()};
    grids_.are_filled = true;
  }

  /// Puts one pass over the spheres on the space's stream.
  template <class NarrowPhase, class Space, class Output>
  void query(Space& space, sphere_view_for<NarrowPhase, S> const& spheres, Output const& output) {
    using pipeline = candidate_pipeline<S, NarrowPhase, Output>;
    bucket_query<S, NarrowPhase, Output> kernel{pipeline{mesh_, spheres, output, measures_.boxes()}, ref_, 0};
    kernel.choose_grid_size(space, spheres.size());
    space.launch(kernel.blocks, kernel);
  }

 private:
  static constexpr std::size_t fixed_bytes =
      sizeof(mesh_statistics<S>) + max_grids * sizeof(grid<S>) + sizeof(measured_radii<S>);

  static constexpr int grids_without_readback = 4;  ///< of so many triangles

  /// True if boxes of triangles are kept: a thread that works alone asks them before it reads a triangle, and a
  /// simulation in each step. Where threads work together to read the mesh again takes less time.
  template <class Space>
  static constexpr bool keeps_boxes =
      Space::template block<compute_mesh_statistics<S>>::num_threads == 1 || serves_steps<Space>;

  /// A grid of its own saves so many spheres less time than it takes to fill.
  std::size_t fewest_of_grid() const { return 2 * mesh_.size(); }

  /// Chooses how far grids reach by the radii of the spheres.
  template <class Space>
  grid_reaches<S> const* choose_reaches(Space& space, sphere_view<S> const& spheres, wanted_grids<S> const& wanted,
                                        bool anew) {
    // of a sorted sphere its own reach decides what is near: grids pay where they reach farther than triangles do
    S enough = 0;
    std::uint64_t fewest = 0;
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      enough = 2 * static_cast<S>(measures_.statistics.data()->extents.median());
    } else {
      fewest = fewest_of_grid();
    }
    auto* const measured = radii_.reserve(space.resource(), 1);
    measure_radii_of(space, spheres, &measured->radii);
    detail::choose_reaches<S> const kernel{&measured->radii, &measured->reaches, wanted.given, enough,
                                           fewest,           wanted.max_count,   anew};
    space.launch(1, kernel);
    return &measured->reaches;
  }

  /// Takes memory for up to `max_count` grids. Where nobody knows how many there will be each may have half the
  /// entries, but two together all of theirs.
  template <class Space>
  void plan_memory(Space& space, int max_count, bool may_be_fewer, std::size_t spheres) {
    auto const* const boxes = measures_.boxes();
    std::size_t const taken = fixed_bytes + (boxes != nullptr ? mesh_.size() * sizeof *boxes : 0);
    auto const plan = memory_plan::make(mesh_.size(), spheres, max_count, limits_.cell_width > 0, taken,
                                        limits_.memory_budget, serves_steps<Space>);
    if (plan.grids == 0) return;
    std::size_t const cells = static_cast<std::size_t>(plan.grids) << plan.table_bits;
    // what is held for another number of cells would come on top of what the budget was planned for
    if (limits_.memory_budget != 0 && grids_.cells != cells) lists_.release();
    grids_.cells = cells;
    auto const grids = static_cast<std::size_t>(plan.grids);
    grids_.entry_limit =
        may_be_fewer ? plan.entries / grids * max<std::size_t>(grids / 2, min<std::size_t>(grids, 2)) : plan.entries;
    grids_.table_bits = plan.table_bits;
    grids_.count = plan.grids;
    grids_.memory.reserve(space.resource(), max_grids);
  }

  template <class Space, class Spheres>
  void plan_cells(Space& space, wanted_grids<S> const& wanted, grid_reaches<S> const* reaches, Spheres const& spheres,
                  float sphere_count, [[maybe_unused]] mesh_view<S> const* mesh) {
    auto* const grids = grids_.memory.data();
    grid_request<S> const request{wanted.reach,
                                  reaches,
                                  grids_.count,
                                  static_cast<S>(limits_.cell_width),
                                  wanted.whole_boxes,
                                  0.5f * static_cast<float>(grids_.entry_limit),
                                  grids_.table_bits,
                                  sphere_count,
                                  bucket_tuning<Space>::costs};
    plan_grid<S, Spheres> kernel{mesh_, measures_.boxes(), spheres, measures_.statistics.data(),
                                 grids, request,           nullptr, 0};
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (mesh != nullptr) kernel.mesh = *mesh, kernel.boxes = nullptr;
    } else {
      kernel.cells = lists_.to_empty(space, grids_.cells);
      kernel.listed = grids_.cells + 1;
    }
    space.launch(kernel.template blocks<typename Space::template block<decltype(kernel)>>(), kernel);
    ref_.grids = grids;  // without lists, until the triangles are entered
    ref_.grid_count = grids_.count;
  }

  bool waits_for_sizes() const { return mesh_.size() > max_without_readback || limits_.cell_width > 0; }

  void forget_grids() {
    grids_.clear();
    ref_ = {{mesh_, measures_.boxes()}, nullptr, 0, nullptr, nullptr, nullptr, nullptr, 0};
  }

  mesh_view<S> mesh_;
  grid_limits limits_;
  mesh_measures<S> measures_;
  grid_set<S> grids_;
  cell_lists<S> lists_;
  bucket_ref<S> ref_ = {};
  buffer<measured_radii<S>> radii_;
};

}  // namespace collide::detail
