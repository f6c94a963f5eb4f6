/// \file
/// Broad phase: uniform grids of buckets. Includes the detector and everything to use it with: with nvcc the CUDA
/// spaces too.
///
/// In the terms of the original study: bucket x host = `bucket_seq`, bucket x cuda = `bucket`, and
/// bucket x cuda_shared = `bucket_shamem`.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <type_traits>

#include <collide/broad/detail/bucket/measure_groups.hpp>
#include <collide/broad/detail/bucket/sorted_spheres.hpp>
#include <collide/broad/detail/bucket/sphere_major.hpp>
#include <collide/broad/detail/grid/cell_lists.hpp>
#include <collide/broad/detail/grid/grid.hpp>
#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/broad/detail/grid/memory_plan.hpp>
#include <collide/broad/detail/grid/mesh_statistics.hpp>
#include <collide/broad/detail/grid/plan.hpp>
#include <collide/detector.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/spaces/detail/block.hpp>
#if defined(COLLIDE_COMPILED)
#include <collide/detectors/compiled.hpp>
#endif

namespace collide {

/// Broad phase: uniform grids of buckets, with cells chosen from the scene; broad/detail/grid/grid.hpp explains how.
/// Build O(triangles + entries), query O(spheres + candidates). Memory: 8 scalars for each triangle, but in
/// `cuda_shared` for simulations only; for each grid entries of 8 bytes, at most 16 for each triangle (48 where there
/// are fewer spheres) and one for each four spheres, and cells of 8 bytes, at most 32 for each triangle; several grids
/// only where radii differ by more than a factor of 4, on a device each but the first for more than two spheres a
/// triangle. The host sorts the spheres instead where there are many (broad/detail/bucket/sorted_spheres.hpp): that
/// takes O(triangles + spheres) for a query, 1 scalar per triangle, about 36 bytes more where triangles that follow
/// each other are far apart, 4 bytes per cell, and about 12 scalars for each sphere in a cell with triangles, 19 if it
/// moves; no entries.
struct bucket {
  /// Width of the cells, in the units of the coordinates; 0 lets the library choose, which is nearly always right. The
  /// study's was 4 R. They are wider where triangles would meet too many of them.
  double cell_width = 0;

  /// Bytes of the space's memory that the grids may take at most; 0 is no limit. The results of sinks are not counted.
  /// If it does not suffice for a grid, spheres are tested with every triangle: slower, with the same result.
  std::size_t memory_budget = 0;

  /// The most triangles of a build; more are refused (`error`). A grid cannot have more than the default: larger meshes
  /// go in_passes.
  std::size_t max_triangles = detail::max_triangles_of_grid;

  template <class S>
  class index;
};

namespace detail {

/// Measures of a mesh. The memory budget may have no room for them: then there are no grids, or no boxes.
template <class S>
struct mesh_measures {
  buffer<mesh_statistics<S>> statistics;
  buffer<triangle_aabb<S>> box_memory;
  bool has_boxes = false;  ///< of this mesh

  /// The boxes of the triangles; null if there are none.
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
  S reach = 0;               ///< of the largest; negative: the radius of the largest sphere
  int max_count = 0;         ///< how many there may be
  bool whole_boxes = false;  ///< spheres that move look for triangles along their paths

  /// True if the radii of the spheres tell how far they reach.
  bool by_radii() const { return max_count > 1 || reach < 0; }

  /// True if these do for spheres that ask for `other`.
  bool serve(wanted_grids const& other) const {
    return reach == other.reach && max_count >= other.max_count && whole_boxes == other.whole_boxes;
  }
};

/// The radii of spheres, and the reaches of grids that follow from them.
template <class S>
struct measured_radii {
  size_histogram radii;
  grid_reaches<S> reaches;
};

/// The grids that an index has.
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

/// Which way round a query goes: spheres look for triangles in the cells, or triangles look for spheres that are sorted
/// into the cells.
enum class query_order { sphere_major, triangle_major };

/// The plan of a query.
template <class S>
struct query_plan {
  wanted_grids<S> grids;     ///< that it needs
  bool makes_grids = false;  ///< those that are there do not serve
  bool asks_radii = false;   ///< those that are there serve unless other radii need others
  std::size_t spheres = 0;   ///< of all queries to come, at least; more pay for narrower cells
  query_order order = query_order::sphere_major;
};

}  // namespace detail

/// The buckets of a mesh.
template <class S>
class bucket::index {
 public:
  /// One pass over the mesh: extent, sizes, and boxes, on the host of groups of triangles. The grids follow as soon as
  /// a radius is known.
  template <class Space>
  void build(Space& space, bucket const& options, mesh_view<S> mesh) {
    if (!(options.cell_width >= 0)) throw error("collide: bucket: the cell width is negative or NaN");
    detail::check_triangles(mesh.size(), options.max_triangles);
    if (options.memory_budget != 0 && mesh.size() != mesh_.size()) {
      measures_.box_memory.release();
      lists_.release();
    }
    mesh_ = mesh;
    queries_ = 0;
    given_.reset();
    measures_.has_boxes = false;
    forget_grids();
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (bins_spheres<Space>(options)) return bins_.measure(space, mesh, measures_.clear(space));
    }
    auto const affords = [&](std::size_t bytes) {
      return options.memory_budget == 0 || bytes <= options.memory_budget;
    };
    if constexpr (keeps_boxes<Space>) {
      if (affords(fixed_bytes + mesh.size() * sizeof(detail::triangle_aabb<S>))) {
        measures_.box_memory.reserve(space.resource(), mesh.size());
        measures_.has_boxes = true;
        forget_grids();
      } else {
        measures_.box_memory.release();
      }
    }
    if (!affords(fixed_bytes)) return measures_.statistics.release();
    auto* const statistics = measures_.clear(space);
    detail::compute_mesh_statistics<S> const kernel{mesh, statistics, measures_.box_memory.data()};
    space.launch(detail::grid_size<Space>(mesh.size(), kernel), kernel);
  }

  /// Says that grids for spheres up to `radius` serve until the next build; the next query makes them, as it knows
  /// better what they cost. Where spheres are sorted into the cells it does nothing.
  template <class Space>
  void prepare(Space&, bucket const& options, S radius) {
    if (bins_spheres<Space>(options)) return;
    bool const serves =
        measures_.statistics.data() != nullptr && detail::is_valid_radius(radius) && detail::is_finite(radius);
    given_ = serves ? detail::wanted_grids<S>{radius, 1} : detail::wanted_grids<S>{};
  }

  /// Makes the grids that the spheres need, unless they are there, and what else the next query needs of the mesh.
  template <class Space>
  void prepare(Space& space, bucket const& options, sphere_view<S> const& spheres) {
    carry_out(space, options, spheres, plan_query(space, options, spheres));
  }

  /// Makes what spheres that move need of the mesh.
  template <class Space>
  void prepare(Space& space, bucket const& options, moving_sphere_view<S> const& spheres) {
    carry_out(space, options, spheres, plan_query(space, options, spheres));
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
      if (sort_if_planned(space, spheres)) {
        return bins_.template expected_hits<NarrowPhase>(space, spheres.size());
      }
    }
    return 0;
  }

  /// Puts one pass over the spheres on the space's stream; the last `prepare` was for these.
  template <class NarrowPhase, class Space, class Output>
  void query(Space& space, detail::sphere_view_for<NarrowPhase, S> const& spheres, Output const& output) {
    using pipeline = detail::candidate_pipeline<S, NarrowPhase, Output>;
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (sort_if_planned(space, spheres)) return bins_.query(space, pipeline{mesh_, spheres, output});
    }
    detail::bucket_query<S, NarrowPhase, Output> kernel{pipeline{mesh_, spheres, output, measures_.boxes()}, ref_, 0};
    kernel.choose_grid_size(space, spheres.size());
    space.launch(kernel.blocks, kernel);
  }

  /// The triangles near a single sphere, for a kernel; valid until the next build or prepare.
  detail::bucket_ref<S> const& mesh_lookup() const { return ref_; }

  /// Width of the finest cells in use; 0 if there is no grid.
  template <class Space>
  double cell_width(Space& space) const {
    return grids_.count == 0 ? 0.0 : static_cast<double>(space.read(&grids_.memory.data()->width));
  }

 private:
  static constexpr std::size_t fixed_bytes = sizeof(detail::mesh_statistics<S>) +
                                             detail::max_grids * sizeof(detail::grid<S>) +
                                             sizeof(detail::measured_radii<S>);

  /// So many queries of few spheres go through all triangles; then these are entered.
  static constexpr std::size_t few_queries = 2;

  /// For at most this many triangles the lists of cells get memory for the largest possible number of entries, and of
  /// so many grids; for more triangles, or cells of a given width, the host reads the numbers back first.
  static constexpr std::size_t max_without_readback = std::size_t{1} << 18;
  static constexpr int grids_without_readback = 4;

  /// So many radii tell how far grids reach below a radius that was given.
  static constexpr std::size_t sampled_radii = 4096;

  /// True if boxes of triangles are kept: a thread that works alone asks them before it reads a triangle, and a
  /// simulation in each step. Where threads work together to read the mesh again takes less time.
  template <class Space>
  static constexpr bool keeps_boxes =
      Space::template block<detail::compute_mesh_statistics<S>>::num_threads == 1 || detail::serves_steps<Space>;

  /// True if spheres can be sorted into the cells: what that takes is not part of a budget.
  template <class Space>
  static bool bins_spheres(bucket const& options) {
    return bucket_tuning<Space>::bins_spheres && options.memory_budget == 0;
  }
  template <class Space>
  static bool can_bin(bucket const& options, std::size_t spheres) {
    return bins_spheres<Space>(options) && spheres <= detail::sorted_spheres<S>::max_size;
  }

  /// The plan of a query of spheres at rest.
  template <class Space>
  detail::query_plan<S> plan_query(Space& space, bucket const& options, sphere_view<S> const& spheres) {
    detail::query_plan<S> plan = plan_grids(space, spheres, grids_.asked.whole_boxes);
    bool const has_grids = plan.makes_grids || grids_.count != 0;
    if (has_grids && can_bin<Space>(options, spheres.size())) {
      // entering the triangles pays where very few spheres come again and again (docs/development/design.md)
      if (queries_ < few_queries || spheres.size() >= mesh_.size() / 128) {
        plan.order = detail::query_order::triangle_major;
        plan.makes_grids = plan.makes_grids || spheres.size() / 8 > grids_.spheres;
      } else {
        plan.spheres = mesh_.size();
        plan.makes_grids = plan.makes_grids || grids_.spheres < plan.spheres;
      }
    }
    return plan;
  }

  /// The plan of a query of spheres that move: they are sorted, too, if there are many, of one radius, and none moves
  /// far; else they look for triangles along their paths.
  template <class Space>
  detail::query_plan<S> plan_query(Space& space, bucket const& options, moving_sphere_view<S> const& spheres) {
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (measures_.statistics.data() != nullptr && spheres.one_radius() && spheres.size() / 4 >= mesh_.size() &&
          can_bin<Space>(options, spheres.size())) {
        S const reach = bins_.reach_of(space, spheres);
        if (detail::is_finite(reach) && reach <= 2 * spheres.common_radius()) {
          detail::query_plan<S> plan;
          // a new one is wider, so that a bit more next time fits too
          plan.grids = {grids_.reach_for(reach, 2, reach + reach / 16), 1, grids_.asked.whole_boxes};
          plan.makes_grids = !grids_.asked.serve(plan.grids);
          plan.order = detail::query_order::triangle_major;
          return plan;
        }
      }
    }
    return plan_grids(space, spheres, true);
  }

  /// The grids for the radius that was given, or for the radii of the spheres: those that are there if they serve.
  template <class Space, class Spheres>
  detail::query_plan<S> plan_grids(Space&, Spheres const& spheres, bool whole_boxes) {
    detail::wanted_grids<S> wanted = given_.value_or(detail::wanted_grids<S>{});
    if (!spheres.one_radius()) {
      if (!given_) wanted = {-1, 1};
      if (wanted.max_count != 0) wanted.max_count = max_grid_count<Space>(spheres.size());
    } else if (S const radius = spheres.common_radius();
               !given_ && detail::is_valid_radius(radius) && detail::is_finite(radius)) {
      wanted = {grids_.reach_for(radius, 4, radius), 1};
    }
    wanted.whole_boxes = whole_boxes;
    detail::query_plan<S> plan;
    plan.makes_grids = measures_.statistics.data() != nullptr && wanted.max_count != 0 && !grids_.asked.serve(wanted);
    plan.grids = plan.makes_grids ? wanted : grids_.asked;
    plan.asks_radii = grids_.count != 0 && plan.grids.reach < 0;
    return plan;
  }

  /// How many grids there may be for spheres of many radii.
  template <class Space>
  int max_grid_count(std::size_t spheres) const {
    if (bucket_tuning<Space>::bins_spheres) return detail::max_grids;
    if (detail::serves_steps<Space> || spheres <= fewest_of_grid()) return 1;
    return mesh_.size() > max_without_readback ? detail::max_grids : grids_without_readback;
  }

  /// A grid of its own saves so many spheres less time than it takes to fill.
  std::size_t fewest_of_grid() const { return 2 * mesh_.size(); }

  /// Makes what a plan needs of the mesh.
  template <class Space, class Spheres>
  void carry_out(Space& space, bucket const& options, Spheres const& spheres, detail::query_plan<S> const& plan) {
    if (plan.makes_grids || plan.asks_radii) make_grids(space, options, plan, spheres);
    ++queries_;
    order_ = plan.order;
    if constexpr (bucket_tuning<Space>::bins_spheres) bins_.clear();
    if (order_ == detail::query_order::sphere_major) fill_grids(space, options);
  }

  /// True if the plan is that triangles look for spheres; these are sorted into the cells then.
  template <class Space, class Spheres>
  bool sort_if_planned(Space& space, Spheres const& spheres) {
    if (order_ != detail::query_order::triangle_major) return false;
    if (!bins_.empty()) return true;
    if constexpr (std::is_same<Spheres, sphere_view<S>>::value) {
      bins_.sort(space, spheres);
    } else {
      bins_.sort(space, detail::swept_bounding_spheres<S>{spheres, grids_.asked.reach});
    }
    return true;
  }

  /// Makes the grids of a plan, as many as the budget allows, for these spheres. Where their radii tell how far they
  /// reach a device sees itself whether those that are there do.
  template <class Space, class Spheres>
  void make_grids(Space& space, bucket const& options, detail::query_plan<S> const& plan, Spheres const& spheres) {
    detail::wanted_grids<S> const wanted = plan.grids;
    bool const waits = bucket_tuning<Space>::bins_spheres || waits_for_sizes(options);
    bool anew = plan.makes_grids || !(waits || grids_.are_filled);
    int max_count = wanted.max_count;
    detail::grid_reaches<S> const* reaches = nullptr;
    if (wanted.by_radii()) {
      reaches = choose_reaches(space, spheres, wanted, anew);
      if (waits) {
        detail::grid_reaches<S> const seen = space.read(reaches);
        if (!seen.are_new) return;
        anew = true;
        max_count = seen.count;
      }
    }
    std::size_t const sphere_count = std::max(spheres.size(), plan.spheres);
    if (anew) {
      forget_grids();  // until all is done: an exception leaves no half-made grid behind
      plan_memory(space, options, max_count, max_count > 1 && !waits, sphere_count);
    }
    grids_.are_filled = false;
    grids_.are_new = reaches == nullptr || waits ? nullptr : &reaches->are_new;
    if (grids_.count != 0) plan_cells(space, options, wanted, reaches, spheres, static_cast<float>(sphere_count));
    grids_.asked = wanted;
    grids_.spheres = sphere_count;
  }

  /// Chooses how far grids reach by the radii of the spheres.
  template <class Space>
  detail::grid_reaches<S> const* choose_reaches(Space& space, sphere_view<S> const& spheres,
                                                detail::wanted_grids<S> const& wanted, bool anew) {
    // of a sorted sphere its own reach decides what is near: grids pay where they reach farther than triangles do
    S enough = 0;
    std::uint64_t fewest = 0;
    std::size_t const stride = wanted.reach < 0 ? 1 : 1 + spheres.size() / sampled_radii;
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      enough = 2 * static_cast<S>(measures_.statistics.data()->extents.median());
    } else {
      fewest = fewest_of_grid() / stride;
    }
    auto* const measured = radii_.reserve(space.resource(), 1);
    detail::measure_radii_of(space, spheres, stride, &measured->radii);
    detail::choose_reaches<S> const kernel{&measured->radii, &measured->reaches, wanted.reach, enough,
                                           fewest,           wanted.max_count,   anew};
    space.launch(1, kernel);
    return &measured->reaches;
  }

  /// Takes memory for up to `max_count` grids. Where nobody knows how many there will be each may have half the
  /// entries.
  template <class Space>
  void plan_memory(Space& space, bucket const& options, int max_count, bool may_be_fewer, std::size_t spheres) {
    auto const* const boxes = measures_.boxes();
    std::size_t const taken = fixed_bytes + (boxes != nullptr ? mesh_.size() * sizeof *boxes : 0);
    auto const plan = detail::memory_plan::make(mesh_.size(), spheres, max_count, options.cell_width > 0, taken,
                                                options.memory_budget, detail::serves_steps<Space>);
    if (plan.grids == 0) return;
    std::size_t const cells = static_cast<std::size_t>(plan.grids) << plan.table_bits;
    // what is held for another number of cells would come on top of what the budget was planned for
    if (options.memory_budget != 0 && grids_.cells != cells) lists_.release();
    grids_.cells = cells;
    grids_.entry_limit = may_be_fewer ? plan.entries / 2 : plan.entries;
    grids_.table_bits = plan.table_bits;
    grids_.count = plan.grids;
    grids_.memory.reserve(space.resource(), detail::max_grids);
  }

  /// Chooses the cells of the grids.
  template <class Space, class Spheres>
  void plan_cells(Space& space, bucket const& options, detail::wanted_grids<S> const& wanted,
                  detail::grid_reaches<S> const* reaches, Spheres const& spheres, float sphere_count) {
    auto* const grids = grids_.memory.data();
    detail::grid_request<S> const request{wanted.reach,
                                          reaches,
                                          grids_.count,
                                          static_cast<S>(options.cell_width),
                                          wanted.whole_boxes,
                                          0.5f * static_cast<float>(grids_.entry_limit),
                                          grids_.table_bits,
                                          sphere_count,
                                          bucket_tuning<Space>::costs};
    detail::plan_grid<S, Spheres> kernel{mesh_, measures_.boxes(), spheres, measures_.statistics.data(),
                                         grids, request,           nullptr, 0};
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (bins_spheres<Space>(options)) kernel.mesh = bins_.mesh().mesh, kernel.boxes = nullptr;
    } else {
      kernel.cells = lists_.to_empty(space, grids_.cells);
      kernel.listed = grids_.cells + 1;
    }
    space.launch(kernel.template blocks<typename Space::template block<decltype(kernel)>>(), kernel);
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (bins_spheres<Space>(options)) bins_.mark(space, grids, grids_.count, grids_.table_bits);
    }
    ref_.grids = grids;  // without lists, until the triangles are entered
    ref_.grid_count = grids_.count;
  }

  /// Enters the triangles into the cells, unless they are there, or there are no grids.
  template <class Space>
  void fill_grids(Space& space, bucket const& options) {
    if (grids_.count == 0 || grids_.are_filled) return;
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (bins_spheres<Space>(options) && !measures_.has_boxes) {
        detail::compute_boxes<S>::run(space, mesh_, measures_.box_memory);
        measures_.has_boxes = true;
      }
    }
    bool const waits = waits_for_sizes(options) || (bucket_tuning<Space>::bins_spheres && grids_.count > 1);
    auto const* const boxes = measures_.boxes();
    auto const* const grids = grids_.memory.data();
    lists_.enter(space, mesh_, boxes, {grids, grids_.count, grids_.table_bits, grids_.cells, grids_.are_new},
                 grids_.entry_limit, waits);
    ref_ = {{mesh_, boxes}, grids,          grids_.count,     lists_.occupied(),
            lists_.data(),  lists_.total(), lists_.entries(), lists_.capacity()};
    grids_.are_filled = true;
  }

  bool waits_for_sizes(bucket const& options) const {
    return mesh_.size() > max_without_readback || options.cell_width > 0;
  }

  void forget_grids() {
    grids_.clear();
    ref_ = {{mesh_, measures_.boxes()}, nullptr, 0, nullptr, nullptr, nullptr, nullptr, 0};
  }

  mesh_view<S> mesh_;
  std::size_t queries_ = 0;                                        ///< since the build
  detail::query_order order_ = detail::query_order::sphere_major;  ///< of the next query
  detail::mesh_measures<S> measures_;
  detail::grid_set<S> grids_;
  std::optional<detail::wanted_grids<S>> given_;  ///< by the caller, until the next build
  detail::cell_lists<S> lists_;
  detail::sorted_spheres<S> bins_;
  detail::bucket_ref<S> ref_ = {};
  buffer<detail::measured_radii<S>> radii_;
};

#if defined(COLLIDE_COMPILED)
COLLIDE_ELSEWHERE(bucket)
#endif

}  // namespace collide
