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
#include <collide/detail/grid/cell_lists.hpp>
#include <collide/detail/grid/grid.hpp>
#include <collide/detail/grid/grid_ref.hpp>
#include <collide/detail/grid/memory_plan.hpp>
#include <collide/detail/grid/mesh_statistics.hpp>
#include <collide/detail/grid/plan.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/detail/query/measure_groups.hpp>
#include <collide/detail/query/sorted_spheres.hpp>
#include <collide/detail/query/sphere_major.hpp>
#include <collide/detector.hpp>
#if defined(COLLIDE_COMPILED)
#include <collide/compiled.hpp>
#endif

namespace collide {

/// Broad phase: uniform grids of buckets, with cells chosen from the scene; detail/grid/grid.hpp explains how.
/// Build O(triangles + entries), query O(spheres + candidates). Memory: 8 scalars for each triangle; for each grid
/// entries of 8 bytes, at most 16 for each triangle (48 where there are fewer spheres) and one for each two spheres,
/// and cells of 8 bytes, at most 32 for each triangle; several grids only where radii differ by more than a factor
/// of 4. The host sorts the spheres instead where there are many (detail/query/sorted_spheres.hpp): that takes
/// O(triangles + spheres) for a query, 1 scalar per triangle, 4 bytes per cell, and about 12 scalars for each sphere in
/// a cell with triangles, 19 if it moves; no entries.
struct bucket {
  /// Width of the cells, in the units of the coordinates; 0 lets the library choose, which is nearly always right. The
  /// study's was 4 R. They are wider where triangles would meet too many of them.
  double cell_width = 0;

  /// Bytes of the space's memory that the grids may take at most; 0 is no limit. The results of sinks are not counted.
  /// Where it does not suffice for a grid, spheres are tested with every triangle: slower, with the same result.
  std::size_t memory_budget = 0;

  /// The most triangles of a build; more are refused (`error`). A grid cannot have more than the default: larger meshes
  /// go in_passes.
  std::size_t most_triangles = detail::most_triangles_of_grid;

  template <class S>
  class index;
};

/// The buckets of a mesh.
template <class S>
class bucket::index {
 public:
  /// One pass over the mesh: extent, sizes, and boxes, on the host of groups of triangles. The grids follow as soon as
  /// a radius is known.
  template <class Space>
  void build(Space& space, bucket const& options, mesh_view<S> mesh) {
    if (!(options.cell_width >= 0)) throw error("collide: bucket: the cell width is negative or NaN");
    detail::check_triangles(mesh.size(), options.most_triangles);
    if (options.memory_budget != 0 && mesh.size() != mesh_.size()) release_grids();
    mesh_ = mesh;
    stage_ = stage::none;
    origin_ = origin::none;
    grid_count_ = requested_ = 0;
    queries_ = 0;
    has_boxes_ = false;
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (bins_spheres<Space>(options)) return bins_.measure(space, mesh, clear_summary(space));
    }
    auto const affords = [&](std::size_t bytes) {
      return options.memory_budget == 0 || bytes <= options.memory_budget;
    };
    if (affords(fixed_bytes + mesh.size() * sizeof(detail::triangle_aabb<S>))) {
      boxes_.reserve(space.resource(), mesh.size());
      has_boxes_ = true;
    } else {
      boxes_.release();
    }
    if (!affords(fixed_bytes)) return summary_.release();
    auto* const summary = clear_summary(space);
    detail::compute_mesh_statistics<S> const kernel{mesh, summary, boxes_.data()};
    space.launch(detail::grid_size<Space>(mesh.size(), kernel), kernel);
  }

  /// Makes a grid for spheres up to `radius`, which serves until the next build, or until many spheres that move want
  /// another.
  template <class Space>
  void prepare(Space& space, bucket const& options, S radius) {
    origin_ = origin::radius;
    if (summary_.data() == nullptr || !detail::is_valid_radius(radius) || !detail::is_finite(radius)) return;
    make_grids(space, options, &radius, 1, detail::vertices_as_spheres<S>{mesh_, radius});
    if (stage_ == stage::planned && !bins_spheres<Space>(options)) enter_triangles(space, options);
  }

  /// Makes the grids that the spheres need, unless they are there, and chooses how they are used. Waits for the host to
  /// see the radii where they differ.
  template <class Space>
  void prepare(Space& space, bucket const& options, sphere_view<S> const& spheres) {
    request_grids(space, options, spheres);
    // entering the triangles pays where few spheres come again and again (docs/development/experiments.md)
    bool const pays = queries_ == 0 || spheres.size() >= mesh_.size() / 8;
    select_algorithm(space, options, pays && stage_ != stage::none && can_bin<Space>(options, spheres.size()));
  }

  /// Spheres that move are binned, too, if there are many, of one radius, and none moves far; else they look for
  /// triangles along their ways.
  template <class Space>
  void prepare(Space& space, bucket const& options, moving_sphere_view<S> const& spheres) {
    bool bins = false;
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (summary_.data() != nullptr && spheres.one_radius() && spheres.size() / 4 >= mesh_.size() &&
          can_bin<Space>(options, spheres.size())) {
        S const reach = bins_.reach_of(space, spheres);
        if (detail::is_finite(reach) && reach <= 2 * spheres.common_radius()) {
          bool const kept = requested_ == 1 && reach <= reaches_[0] && reaches_[0] <= 2 * reach;
          if (!kept) {
            S const wider = reach + reach / 16;  // so that a bit more next time fits too
            make_grids(space, options, &wider, 1, spheres);
            origin_ = origin::spheres;
          }
          bins = stage_ != stage::none;
        }
      }
    }
    if (!bins) {
      if (!whole_boxes_ && stage_ != stage::none) {  // made for a radius, before it was known that spheres move
        whole_boxes_ = true;
        S reaches[detail::max_grids];
        for (int i = 0; i < detail::max_grids; ++i) reaches[i] = reaches_[i];
        make_grids(space, options, reaches, requested_, spheres);
      }
      whole_boxes_ = true;
      request_grids(space, options, spheres);
    }
    select_algorithm(space, options, bins);
  }

  /// Makes room for queries of up to so many spheres.
  template <class Space>
  void reserve(Space& space, std::size_t spheres) {
    if constexpr (bucket_tuning<Space>::bins_spheres) bins_.reserve(space, spheres);
  }

  /// About how many hits a pass over the spheres has, rather too many; 0 if it is not known, or hardly worth a look.
  /// The last `prepare` was for these.
  template <class NarrowPhase, class Space>
  std::uint64_t expected_hits([[maybe_unused]] Space& space,
                              [[maybe_unused]] detail::sphere_view_for<NarrowPhase, S> const& spheres) {
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (algorithm_ == algorithm::triangle_major) {
        if (bins_.empty()) bin(space, spheres);
        return bins_.template expected_hits<NarrowPhase>(space, mesh_, spheres.size());
      }
    }
    return 0;
  }

  /// Puts one pass over the spheres on the space's stream; the last `prepare` was for these.
  template <class NarrowPhase, class Space, class Output>
  void query(Space& space, detail::sphere_view_for<NarrowPhase, S> const& spheres, Output const& output) {
    using pipeline = detail::candidate_pipeline<S, NarrowPhase, Output>;
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (algorithm_ == algorithm::triangle_major) {
        if (bins_.empty()) bin(space, spheres);
        bins_.query(space, pipeline{mesh_, spheres, output});
        return;
      }
    }
    detail::bucket_query<S, NarrowPhase, Output> kernel{pipeline{mesh_, spheres, output, boxes()}, triangle_ref(), 0,
                                                        0};
    kernel.choose_grid_size(space, spheres.size());
    space.launch(kernel.blocks, kernel);
  }

  /// What a kernel asks for the triangles near a single sphere; valid until the next build or prepare.
  detail::bucket_ref<S> triangle_ref() const {
    return {{mesh_, boxes()}, grids_.data(),  grid_count_,      lists_.occupied(),
            lists_.data(),    lists_.total(), lists_.entries(), lists_.capacity()};
  }

  /// Width of the finest cells in use; 0 if there is no grid.
  template <class Space>
  double cell_width(Space& space) const {
    return grid_count_ == 0 ? 0.0 : static_cast<double>(space.read(&grids_.data()->width));
  }

 private:
  /// How far the grids have come: there are none; their cells are chosen; the triangles are entered into the cells.
  enum class stage { none, planned, entered };

  /// What the grids are for: nothing yet; a radius that was given; the radii that the spheres have.
  enum class origin { none, radius, spheres };

  /// How a query goes: spheres look for triangles in the cells, or triangles look for spheres that are binned into the
  /// cells.
  enum class algorithm { sphere_major, triangle_major };

  static constexpr std::size_t fixed_bytes =
      sizeof(detail::mesh_statistics<S>) + detail::max_grids * sizeof(detail::grid<S>) + sizeof(detail::size_histogram);

  /// Up to so many triangles entries have memory for as many as there may be; the device is asked how many there are if
  /// there are more triangles, or several grids.
  static constexpr std::size_t max_without_readback = std::size_t{1} << 18;

  /// True if spheres can be binned into the cells: what that takes is not part of a budget.
  template <class Space>
  static bool bins_spheres(bucket const& options) {
    return bucket_tuning<Space>::bins_spheres && options.memory_budget == 0;
  }
  template <class Space>
  static bool can_bin(bucket const& options, std::size_t spheres) {
    return bins_spheres<Space>(options) && spheres <= detail::sorted_spheres<S>::most;
  }

  template <class Space>
  detail::mesh_statistics<S>* clear_summary(Space& space) {
    auto* const summary = summary_.reserve(space.resource(), 1);
    detail::mesh_statistics<S>::clear(space, summary);
    return summary;
  }

  /// The boxes of the triangles; null if there are none.
  detail::triangle_aabb<S> const* boxes() const { return has_boxes_ ? boxes_.data() : nullptr; }

  /// Chooses the algorithm of the next query, and makes what it needs of the mesh.
  template <class Space>
  void select_algorithm(Space& space, bucket const& options, bool bins) {
    algorithm_ = bins ? algorithm::triangle_major : algorithm::sphere_major;
    bins_.clear();
    ++queries_;
    if (!bins && stage_ == stage::planned) enter_triangles(space, options);
  }

  template <class Space>
  void bin(Space& space, sphere_view<S> const& spheres) {
    bins_.sort(space, spheres);
  }
  template <class Space>
  void bin(Space& space, moving_sphere_view<S> const& spheres) {
    bins_.sort(space, detail::swept_bounding_spheres<S>{spheres, reaches_[0]});
  }

  /// Makes the grids for the radii of the spheres, unless they are there or a radius was given.
  template <class Space, class Spheres>
  void request_grids(Space& space, bucket const& options, Spheres const& spheres) {
    if (origin_ == origin::radius || summary_.data() == nullptr) return;
    S reaches[detail::max_grids];
    int const n = spheres.one_radius()
                      ? reach_of(spheres.common_radius(), reaches)
                      : detail::reaches_of(detail::histogram_of_radii<S>(space, spheres, radii_), reaches);
    if (n == 0 || (n == requested_ && std::equal(reaches, reaches + n, reaches_))) return;
    origin_ = origin::spheres;
    make_grids(space, options, reaches, n, spheres);
  }

  /// The grid of one radius: the one that is there if it is not much too wide.
  int reach_of(S radius, S* reaches) const {
    if (!detail::is_valid_radius(radius) || !detail::is_finite(radius)) return 0;
    bool const kept = requested_ == 1 && radius <= reaches_[0] && reaches_[0] <= 4 * radius;
    reaches[0] = kept ? reaches_[0] : radius;
    return 1;
  }

  /// Chooses the cells of grids up to these radii, as many of `requested` as the budget allows, for these spheres.
  template <class Space, class Spheres>
  void make_grids(Space& space, bucket const& options, S const* reaches, int requested, Spheres const& spheres) {
    stage_ = stage::none;  // until all is done: an exception leaves no half-made grid behind
    grid_count_ = requested_ = 0;
    std::size_t const taken = fixed_bytes + (boxes() != nullptr ? mesh_.size() * sizeof *boxes() : 0);
    auto const plan = detail::memory_plan::make(mesh_.size(), spheres.size(), requested, options.cell_width > 0, taken,
                                                options.memory_budget);
    for (int i = 0; i < detail::max_grids && i < requested; ++i) reaches_[i] = reaches[i];
    if (plan.grids != 0) {
      auto const count = static_cast<std::size_t>(plan.grids);
      // what is held for another number of cells would come on top of what the budget was planned for
      if (options.memory_budget != 0 && cells_ != count << plan.table_bits) lists_.release();
      cells_ = count << plan.table_bits;
      entry_limit_ = plan.entries;
      table_bits_ = plan.table_bits;
      auto* const grids = grids_.reserve(space.resource(), detail::max_grids);
      detail::grid_request<S> request{{},
                                      plan.grids,
                                      static_cast<S>(options.cell_width),
                                      whole_boxes_,
                                      0.5f * static_cast<float>(plan.entries) / static_cast<float>(plan.grids),
                                      plan.table_bits,
                                      bucket_tuning<Space>::costs};
      for (int i = 0; i < detail::max_grids; ++i) request.reaches[i] = reaches_[i];
      space.launch(count, detail::plan_grid<S, Spheres>{mesh_, boxes(), spheres, summary_.data(), grids, request});
      if constexpr (bucket_tuning<Space>::bins_spheres) {
        if (bins_spheres<Space>(options)) {
          bins_.mark(space, mesh_, grids, plan.grids, plan.table_bits);
        }
      }
      grid_count_ = plan.grids;
      stage_ = stage::planned;
    }
    requested_ = requested;
  }

  /// Enters the triangles into the cells.
  template <class Space>
  void enter_triangles(Space& space, bucket const& options) {
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (bins_spheres<Space>(options) && !has_boxes_) detail::compute_boxes<S>::run(space, mesh_, boxes_);
      has_boxes_ = has_boxes_ || bins_spheres<Space>(options);
    }
    bool const waits_for_size = mesh_.size() > max_without_readback || grid_count_ > 1 || options.cell_width > 0;
    lists_.enter(space, mesh_, boxes(), {grids_.data(), grid_count_, table_bits_, cells_}, entry_limit_,
                 waits_for_size);
    stage_ = stage::entered;
  }

  void release_grids() {
    boxes_.release();
    lists_.release();
  }

  mesh_view<S> mesh_;
  stage stage_ = stage::none;
  origin origin_ = origin::none;
  algorithm algorithm_ = algorithm::sphere_major;
  std::size_t queries_ = 0;  ///< since the build
  int requested_ = 0;        ///< how many grids are wanted: the budget may have allowed fewer
  int grid_count_ = 0;
  S reaches_[detail::max_grids] = {};  ///< of the grids that are wanted
  bool whole_boxes_ = false;           ///< spheres that move look for triangles along their ways
  std::size_t cells_ = 0, entry_limit_ = 0;
  std::uint32_t table_bits_ = 0;
  bool has_boxes_ = false;                      ///< of this mesh
  buffer<detail::triangle_aabb<S>> boxes_;      ///< empty if the budget has no room for them, or nothing needs them
  buffer<detail::mesh_statistics<S>> summary_;  ///< empty if the budget has no room for it
  buffer<detail::size_histogram> radii_;
  buffer<detail::grid<S>> grids_;
  detail::cell_lists<S> lists_;
  detail::sorted_spheres<S> bins_;
};

#if defined(COLLIDE_COMPILED)
COLLIDE_ELSEWHERE(bucket)
#endif

}  // namespace collide
