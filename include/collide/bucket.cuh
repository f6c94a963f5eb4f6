/// \file
/// Broad phase: uniform grids of buckets. Includes the detector and everything to use it with: with nvcc the CUDA
/// spaces too.
///
/// In the terms of the original study: bucket x host = `bucket_seq`, bucket x cuda = `bucket`, and
/// bucket x cuda_shared = `bucket_shamem`.
#pragma once

#include <algorithm>
#include <optional>
#include <type_traits>

#include <collide/broad/detail/bucket/cell_index.hpp>
#include <collide/broad/detail/bucket/sorted_spheres.hpp>
#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/broad/detail/grid/memory_plan.hpp>
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
/// only where radii differ by more than a factor of 4. A device has room for four, each with half of its entries, where
/// radii differ and there are more than two spheres a triangle. The host sorts the spheres instead where there are many
/// (broad/detail/bucket/sorted_spheres.hpp): that takes O(triangles + spheres) for a query, 1 scalar per triangle,
/// about 36 bytes more where triangles that follow each other are far apart, 4 bytes per cell, and about 12 scalars for
/// each sphere in a cell with triangles, 19 if it moves; no entries.
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

/// Which way round a query goes: spheres look for triangles in the cells, or triangles look for spheres that are sorted
/// into the cells; `cheaper` is the first unless the spheres have many triangles in their cells.
enum class query_order { sphere_major, triangle_major, cheaper };

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
    mesh_ = mesh;
    queries_ = 0;
    given_.reset();
    cells_.start(mesh, {options.cell_width, options.memory_budget});
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (bins_spheres<Space>(options)) return bins_.measure(space, mesh, cells_.clear_statistics(space));
    }
    cells_.measure(space);
  }

  /// Says that grids for spheres up to `radius` serve until the next build; the next query makes them, as it knows
  /// better what they cost: several if its spheres are many and of many radii. Where spheres are sorted into the cells
  /// it does nothing.
  template <class Space>
  void prepare(Space&, bucket const& options, S radius) {
    if (bins_spheres<Space>(options)) return;
    bool const serves = cells_.is_measured() && detail::is_valid_radius(radius) && detail::is_finite(radius);
    given_ = serves ? detail::wanted_grids<S>{radius, 1, false, radius} : detail::wanted_grids<S>{};
  }

  /// Makes the grids that the spheres need, unless they are there.
  template <class Space, class Spheres>
  void plan(Space& space, bucket const& options, Spheres const& spheres) {
    detail::query_plan<S> const needed = plan_query(space, options, spheres);
    order_ = needed.order;
    if (!needed.makes_grids && !needed.asks_radii) return;
    std::size_t const all = std::max(spheres.size(), needed.spheres);
    auto const make = [&](mesh_view<S> const* mesh, auto const& mark) {
      cells_.make_grids(space, needed.grids, needed.makes_grids, spheres, all, mesh, mark);
    };
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (bins_spheres<Space>(options)) {
        return make(&bins_.mesh().mesh, [&](detail::grid<S> const* grids, int count, std::uint32_t table_bits) {
          bins_.mark(space, grids, count, table_bits);
        });
      }
    }
    make(nullptr, [](auto const&...) {});
  }

  /// Makes the grids that the spheres need, and enters the triangles or sorts the spheres into their cells.
  template <class Space>
  void prepare(Space& space, bucket const& options, sphere_view<S> const& spheres) {
    plan(space, options, spheres);
    fill(space, spheres);
  }

  /// Sorts the spheres into the cells, or enters the triangles, as planned for them last.
  template <class Space, class Spheres>
  void fill(Space& space, [[maybe_unused]] Spheres const& spheres) {
    ++queries_;
    if (!sorts_spheres()) cells_.fill(space);
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if constexpr (std::is_same<Spheres, sphere_view<S>>::value) {
        if (order_ == detail::query_order::cheaper && !prefers_cells(spheres))
          order_ = detail::query_order::triangle_major;
      }
      if (sorts_spheres()) bins_.sort(space, spheres);
    }
  }

  /// Makes the grids that spheres which move need, and enters the triangles or sorts the spheres.
  template <class Space>
  void prepare(Space& space, bucket const& options, moving_sphere_view<S> const& spheres) {
    plan(space, options, spheres);
    fill(space, detail::swept_bounding_spheres<S>{spheres, cells_.grids().asked.reach});
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
      if (sorts_spheres()) return bins_.template expected_hits<NarrowPhase>(space, spheres.size());
    }
    return 0;
  }

  /// Puts one pass over the spheres on the space's stream; the last `prepare` was for these.
  template <class NarrowPhase, class Space, class Output>
  void query(Space& space, detail::sphere_view_for<NarrowPhase, S> const& spheres, Output const& output) {
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      using pipeline = detail::candidate_pipeline<S, NarrowPhase, Output>;
      if (sorts_spheres()) return bins_.query(space, pipeline{mesh_, spheres, output});
    }
    cells_.template query<NarrowPhase>(space, spheres, output);
  }

  /// Memory that is free during a query.
  detail::spare_pairs spare() const { return cells_.spare(); }

  /// The triangles near a single sphere, for a kernel; valid until the next build or prepare.
  detail::bucket_ref<S> const& mesh_lookup() const { return cells_.ref(); }

  /// Width of the finest cells in use; 0 if there is no grid.
  template <class Space>
  double cell_width(Space& space) const {
    auto const& made = cells_.grids();
    return made.count == 0 ? 0.0 : static_cast<double>(space.read(&made.memory.data()->width));
  }

 private:
  /// True if the triangles are entered for spheres of which there are few: that takes as long as 3 to 25 queries in
  /// which all triangles look for spheres, and pays where few come again and again; after two queries of a 128th as
  /// many spheres as triangles, after 32 of an eighth.
  bool enters_triangles(std::size_t spheres) const {
    return queries_ >= 2 && spheres <= mesh_.size() / 8 && queries_ * mesh_.size() >= 256 * spheres;
  }

  /// True if spheres that look for triangles, which are entered, take less time than the other way round.
  template <class Spheres>
  bool prefers_cells(Spheres const& spheres) const {
    constexpr float per_sphere_ns = 15, per_candidate_ns = 100, per_triangle_ns = 20, per_pair_ns = 8;  // of the host
    auto const n = static_cast<float>(spheres.size()), candidates = n * cells_.mean_candidates(spheres);
    return per_sphere_ns * n + per_candidate_ns * candidates <
           per_triangle_ns * static_cast<float>(mesh_.size()) + per_pair_ns * candidates;
  }

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
    detail::query_plan<S> plan = plan_grids(space, spheres, cells_.grids().asked.whole_boxes);
    bool const has_grids = plan.makes_grids || cells_.grids().count != 0;
    if (has_grids && can_bin<Space>(options, spheres.size())) {
      if (!enters_triangles(spheres.size())) {
        plan.order = detail::query_order::triangle_major;
        plan.makes_grids = plan.makes_grids || spheres.size() / 8 > cells_.grids().spheres;
      } else {
        plan.order = detail::query_order::cheaper;
        plan.spheres = mesh_.size();
        plan.makes_grids = plan.makes_grids || cells_.grids().spheres < plan.spheres;
      }
    }
    // few of many triangles are read again by a query, so narrower cells hardly take longer to fill
    if (!bucket_tuning<Space>::bins_spheres && mesh_.size() > detail::cell_index<S>::max_without_readback &&
        spheres.size() <= mesh_.size() / 4) {
      plan.spheres = 8 * spheres.size();
    }
    return plan;
  }

  /// The plan of a query of spheres that move: they are sorted, too, if there are many, of one radius, and none moves
  /// far; else they look for triangles along their paths.
  template <class Space>
  detail::query_plan<S> plan_query(Space& space, bucket const& options, moving_sphere_view<S> const& spheres) {
    if constexpr (bucket_tuning<Space>::bins_spheres) {
      if (cells_.is_measured() && spheres.one_radius() && spheres.size() / 4 >= mesh_.size() &&
          can_bin<Space>(options, spheres.size())) {
        S const reach = bins_.reach_of(space, spheres);
        if (detail::is_finite(reach) && reach <= 2 * spheres.common_radius()) {
          detail::query_plan<S> plan;
          // a new one is wider, so that a bit more next time fits too
          plan.grids = {cells_.grids().reach_for(reach, 2, reach + reach / 16), 1, cells_.grids().asked.whole_boxes};
          plan.makes_grids = !cells_.grids().asked.serve(plan.grids);
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
    auto const& asked = cells_.grids().asked;
    if (given_ && wanted.max_count != 0 && asked.max_count != 0 && asked.by_radii() && asked.given == wanted.given) {
      wanted = asked;  // they serve any radii
    } else if (given_ && wanted.max_count != 0 && !spheres.one_radius()) {
      // to look at the radii takes a while, so only where there are spheres for two more grids
      wanted.max_count = cells_.template max_grid_count<Space>(spheres.size() / 2);
      if (wanted.max_count > 1) wanted.reach = -1;
    } else if (!given_) {
      S const radius = spheres.common_radius();
      if (!spheres.one_radius()) {
        wanted = {-1, cells_.template max_grid_count<Space>(spheres.size())};
      } else if (detail::is_valid_radius(radius) && detail::is_finite(radius)) {
        wanted = {cells_.grids().reach_for(radius, 4, radius), 1};
      }
    }
    wanted.whole_boxes = whole_boxes;
    detail::query_plan<S> plan;
    plan.makes_grids = cells_.is_measured() && wanted.max_count != 0 && !cells_.grids().asked.serve(wanted);
    plan.grids = plan.makes_grids ? wanted : cells_.grids().asked;
    plan.asks_radii = cells_.grids().count != 0 && plan.grids.by_radii() && !given_;
    return plan;
  }

  /// True if triangles look for spheres that are sorted into the cells.
  bool sorts_spheres() const { return order_ == detail::query_order::triangle_major; }

  mesh_view<S> mesh_;
  std::size_t queries_ = 0;                                        ///< since the build
  detail::query_order order_ = detail::query_order::sphere_major;  ///< of the next query
  std::optional<detail::wanted_grids<S>> given_;                   ///< by the caller, until the next build
  detail::cell_index<S> cells_;                                    ///< spheres look into cells,
  detail::sorted_spheres<S> bins_;                                 ///< or triangles look for spheres
};

#if defined(COLLIDE_COMPILED)
COLLIDE_ELSEWHERE(bucket)
#endif

}  // namespace collide
