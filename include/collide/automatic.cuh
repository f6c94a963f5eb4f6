/// \file
/// Broad phase: `all_pairs`, `bucket` or `bvh`, whichever the scene makes the fastest.
#pragma once

#include <cmath>
#include <type_traits>

#include <collide/all_pairs.cuh>
#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/broad/detail/per_sphere.hpp>
#include <collide/broad/detail/tree/triangle_pieces.hpp>
#include <collide/bucket.cuh>
#include <collide/bvh.cuh>

namespace collide {

namespace detail {

/// The lookup of `automatic`. Which of the two is asked is the same for all spheres.
template <class S, class Tree>
struct grid_or_tree_ref : bucket_ref<S> {
  per_sphere_ref<S, Tree> tree;  ///< of a mesh without triangles if the cells are asked

  COLLIDE_HD_INLINE bool asks_tree() const {
    return COLLIDE_ON_DEVICE(false, tree.mesh.size() != 0);  // `automatic` makes none on a device
  }

  COLLIDE_HD grid_or_tree_ref opened() const { return {bucket_ref<S>::opened(), tree}; }
  COLLIDE_HD_INLINE bool has_single_cell_lookup(S radius) const {
    return !asks_tree() && bucket_ref<S>::has_single_cell_lookup(radius);
  }
  template <class Sphere>
  COLLIDE_HD bool empty(Sphere const& s) const {
    return asks_tree() ? tree.empty(s) : bucket_ref<S>::empty(s);
  }
  template <class Sphere>
  COLLIDE_HD candidate_cursor begin(Sphere const& s) const {
    return asks_tree() ? tree.begin(s) : bucket_ref<S>::begin(s);
  }
  template <class Sphere>
  COLLIDE_HD bool next(Sphere const& s, candidate_cursor& c, std::uint32_t max_count, candidate_range& range) const {
    return asks_tree() ? tree.next(s, c, max_count, range) : bucket_ref<S>::next(s, c, max_count, range);
  }
};

}  // namespace detail

/// Broad phase: chooses for each query. Testing all pairs has next to nothing to build, and wins for few spheres as
/// long as no index has been made; that follows from the numbers of triangles and spheres, by the measured costs of the
/// space (bench/results/README.md), and on the host from how many of up to 32 triangles are near up to 32 of the
/// spheres. `bucket` wins for all else, but on the host for some meshes of long thin triangles, where `bvh` does: if
/// most of the boxes of 32 triangles is empty, it counts how many of 128, and how many would be candidates in the cells
/// that `bucket` plans, up to 128 of the spheres touch; the first query asks so, then every 16th, and where there are
/// twice or half as many spheres. After `build`
/// with a radius it is one of these two. On a device it is never `bvh`.
///
/// The same calls always go the same way, and the pairs are the same either way. It is chosen by the
/// first query for which it pays, counting what the queries before it would have saved.
/// Complexity and memory are those of the chosen one; with a memory budget `bvh` is not chosen.
///
/// A simulation chooses between `bucket` and `bvh` once for a mesh, as soon as it has that and particles: for many
/// steps, however long the build takes, and as if the particles, as large as the first, were at the mesh. Its bits are
/// the same either way.
struct automatic {
  bucket grid;  ///< options of `bucket`, for where that is chosen

  template <class S>
  class index {
   public:
    template <class Space>
    void build(Space&, automatic const&, mesh_view<S> mesh) {
      mesh_ = mesh;
      has_grid_ = has_bounds_ = has_tree_ = is_given_ = is_compact_ = false;
      spent_ = spent_on_boxes_ = 0;
      choices_ = {};
    }

    /// Makes a grid, unless it cannot be: there is an index for the first query.
    template <class Space>
    void prepare(Space& space, automatic const& options, S radius) {
      strategy_ = best_without_tree(options);
      is_given_ = true;
      make_index(space, options, radius);
    }

    /// Chooses for spheres; in a simulation once, for all until the next build, as if they were at the mesh.
    template <class Space, class Spheres>
    void prepare(Space& space, automatic const& options, Spheres const& spheres) {
      if constexpr (detail::serves_steps<Space>) {
        if (!is_given_)
          strategy_ = prefers_tree_in_steps<Space>(options, spheres) ? strategy::tree : best_without_tree(options);
        is_given_ = true;
      } else {
        strategy_ = choose(space, options, spheres);
      }
      make_index(space, options, spheres);
    }

    /// Makes room for queries of up to so many spheres.
    template <class Space>
    void reserve([[maybe_unused]] Space& space, [[maybe_unused]] std::size_t spheres) {
      if constexpr (detail::is_valid<detail::index_reserve, bucket::index<S>, Space>) grid_.reserve(space, spheres);
    }

    /// About how many hits the query has, if the grid can tell; else 0.
    template <class NarrowPhase, class Space>
    std::uint64_t expected_hits(Space& space, detail::sphere_view_for<NarrowPhase, S> const& spheres) {
      return strategy_ == strategy::grid ? grid_.template expected_hits<NarrowPhase>(space, spheres) : 0;
    }

    template <class NarrowPhase, class Space, class Output>
    void query(Space& space, detail::sphere_view_for<NarrowPhase, S> const& spheres, Output const& output) {
      if constexpr (bvh_tuning<Space>::divides_by_area) {
        if (strategy_ == strategy::tree) return tree_.template query<NarrowPhase>(space, spheres, output);
      }
      if (strategy_ == strategy::grid) {
        grid_.template query<NarrowPhase>(space, spheres, output);
      } else {
        bounds_.template query<NarrowPhase>(space, spheres, output);
      }
    }

    /// Memory that is free during a query.
    detail::spare_pairs spare() const { return strategy_ == strategy::grid ? grid_.spare() : detail::spare_pairs{}; }

    /// The triangles near a single sphere, for a kernel of a simulation; valid until the next build or prepare.
    auto mesh_lookup() const {
      using ref = detail::grid_or_tree_ref<S, decltype(tree_.ref())>;
      if (strategy_ == strategy::grid) return ref{grid_.mesh_lookup(), {}};
      detail::bucket_ref<S> const all{{mesh_, nullptr}, nullptr, 0, nullptr, nullptr, nullptr, nullptr, 0};
      return strategy_ == strategy::tree ? ref{all, tree_.mesh_lookup()} : ref{all, {}};
    }

    /// Width of the finest cells in use; 0 if there is no grid.
    template <class Space>
    double cell_width(Space& space) const {
      return has_grid_ && strategy_ != strategy::tree ? grid_.cell_width(space) : 0.0;
    }

   private:
    enum class strategy { all_pairs, grid, tree };

    strategy best_without_tree(automatic const& options) const {
      return detail::fits_grid(mesh_.size(), options.grid.max_triangles) ? strategy::grid : strategy::all_pairs;
    }

    template <class Space, class Spheres>
    strategy choose(Space& space, automatic const& options, Spheres const& spheres) {
      is_planned_ = false;
      bool const wants_index =
          has_grid_ || has_tree_ || (best_without_tree(options) == strategy::grid && wants_grid<Space>(spheres));
      if (!wants_index) return strategy::all_pairs;
      return prefers_tree(space, options, spheres) ? strategy::tree : strategy::grid;
    }

    template <class Space, class Spheres>
    bool wants_grid(Spheres const& spheres) {
      constexpr broad_phase_cost_model c = broad_phase_costs<Space>::value;
      auto const n = static_cast<double>(spheres.size()), triangles = static_cast<double>(mesh_.size());
      double const spared = has_bounds_ ? 0 : c.per_bound_ns;  // of all pairs, which then need not be made
      double const build = c.build_ns + (c.per_triangle_ns - spared) * triangles;
      double saved = std::ceil(n / c.together) * c.together * c.per_pair_ns * triangles - n * c.per_sphere_ns;
      if constexpr (Space::host_accessible) {
        if (build >= saved + spent_) saved += n * c.per_near_ns * triangles_near(spheres);
      }
      // as long as a query does not pay for the grid alone, nobody knows whether there will be another
      return pays(build, saved, spent_);
    }

    /// The mean number of triangles whose bounding sphere a sphere reaches, of a few of both; not 0, as others may.
    template <class Spheres>
    double triangles_near(Spheres const& spheres) const {
      std::size_t const few = 1 + detail::max(spheres.size(), mesh_.size()) / 8;  // it takes a part of the query
      std::size_t const n = detail::min(spheres.size(), detail::min<std::size_t>(few, 32)),
                        m = detail::min<std::size_t>(mesh_.size(), 32);
      std::size_t near = 1;
      for (std::size_t k = 0; k < m; ++k) {
        auto const around = detail::bounding_sphere_of(mesh_[mesh_.size() / m * k]);
        for (std::size_t i = 0; i < n; ++i) {
          auto const s = detail::swept_bounding_sphere(spheres[spheres.size() / n * i]);
          near += around.overlaps(s.centre, s.radius);
        }
      }
      return n * m == 0 ? 0 : static_cast<double>(near * mesh_.size()) / static_cast<double>(n * m);
    }

    /// True if long thin triangles keep a grid so busy that a tree is faster, the build included.
    template <class Space, class Spheres>
    bool prefers_tree([[maybe_unused]] Space& space, [[maybe_unused]] automatic const& options,
                      [[maybe_unused]] Spheres const& spheres) {
      if constexpr (bvh_tuning<Space>::divides_by_area) {
        if (options.grid.memory_budget != 0 || is_compact_) return false;
        if (choices_.is_due(spheres.size())) estimate_tree(space, options, spheres);
        return choices_.saved > 0 && pays(has_tree_ ? 0 : choices_.build, choices_.saved, spent_on_boxes_);
      } else {
        return false;
      }
    }

    /// Estimates what a tree takes to build, and what it saves of this query. The grid is planned for that, but holds
    /// no triangles yet.
    template <class Space, class Spheres>
    void estimate_tree(Space& space, automatic const& options, Spheres const& spheres) {
      constexpr tree_cost_model c = tree_costs;
      choices_.saved = 0;
      is_compact_ = !detail::sampled_triangles<S>(mesh_, 32).are_slender();
      if (is_compact_) return;
      detail::sampled_triangles<S> const sample(mesh_);
      auto const n = static_cast<double>(spheres.size()), triangles = static_cast<double>(mesh_.size());
      double const passed = c.per_triangle_ns * triangles,
                   around = sample.boxes(spheres, detail::min(8 + spheres.size() / 4096, std::size_t{64}));
      if (passed + n * c.per_box_ns * around <= n * c.per_sphere_ns) return;  // it does not save anything
      detail::planned_candidates<S> candidates;
      if constexpr (std::is_same<Spheres, sphere_view<S>>::value) {
        build_grid(space, options);
        grid_.plan(space, options.grid, spheres);
        is_planned_ = true;
        auto const made = grid_.mesh_lookup();
        candidates = {made.grids, made.grid_count};
      }
      choices_.build = c.per_built_piece_ns * sample.pieces() * triangles;
      double const per_sample_ns = 150 + 70 * around * detail::min(1.0, sample.capacity / triangles);
      for (double count = 8;;) {  // mostly these tell
        auto const mean = sample.reached(spheres, static_cast<std::size_t>(count), candidates);
        choices_.saved = passed + n * saved_by_tree(c, mean);
        // more, up to a thirtieth of the query
        double const affords = (passed + n * c.per_box_ns * (1 + mean.candidates)) / (30 * per_sample_ns);
        if (count > 8 || choices_.build > 8 * (choices_.saved + spent_on_boxes_) || affords < 16) break;
        count = detail::min(affords, 128.0);
      }
    }

    /// True if a tree is faster in the steps of a simulation, which are many.
    template <class Space>
    bool prefers_tree_in_steps([[maybe_unused]] automatic const& options,
                               [[maybe_unused]] sphere_view<S> const& spheres) const {
      if constexpr (bvh_tuning<Space>::divides_by_area) {
        if (options.grid.memory_budget != 0) return false;
        detail::sampled_triangles<S> const sample(mesh_);
        if (!sample.are_slender()) return false;
        S const radius = spheres.one_radius() ? spheres.common_radius() : spheres[0].radius;
        detail::middles_as_spheres<S> const middles{mesh_, radius};
        return saved_by_tree(tree_costs_of_steps, sample.reached(middles, 128)) > 0;
      } else {
        return false;
      }
    }

    /// Nanoseconds by which a tree is faster than a grid, for each sphere.
    static double saved_by_tree(tree_cost_model const& c, detail::reached_by_sphere const& mean) {
      return c.per_box_ns * mean.candidates - c.per_sphere_ns - c.per_touched_ns * mean.triangles -
             c.per_piece_ns * (mean.pieces - mean.triangles);
    }

    /// True if what is saved pays for a build, with what queries have lost so far; else this one adds to that.
    static bool pays(double build, double saved, double& lost) {
      if (build < saved + lost) return true;
      lost += saved > 0 ? saved : 0;
      return false;
    }

    /// The last estimate of what a tree takes and saves, in nanoseconds. That takes time too, so it is made again by
    /// every sixteenth query, and by one of twice or half as many spheres.
    struct tree_choices {
      std::size_t queries = 0, next = 0, spheres = 0;  ///< queries so far, and the next that asks
      double build = 0, saved = 0;

      bool is_due(std::size_t n) {
        bool const is_alike = n / 2 <= spheres && spheres / 2 <= n;
        if (++queries < next && is_alike) return false;
        next = queries + 16;
        spheres = n;
        return true;
      }
    };

    /// Makes what the strategy of this query needs, for a radius or for spheres.
    template <class Space, class RadiusOrSpheres>
    void make_index(Space& space, automatic const& options, RadiusOrSpheres const& what) {
      if (strategy_ == strategy::tree) {
        if constexpr (bvh_tuning<Space>::divides_by_area) {
          if (!has_tree_) tree_.build(space, bvh(), mesh_);
          has_tree_ = true;
        }
      } else if (strategy_ == strategy::grid) {
        build_grid(space, options);
        if constexpr (std::is_same<RadiusOrSpheres, sphere_view<S>>::value) {
          if (is_planned_) return grid_.fill(space, what);
        }
        grid_.prepare(space, options.grid, what);
      } else {
        if (!has_bounds_) bounds_.build(space, all_pairs(), mesh_);
        has_bounds_ = true;
      }
    }

    template <class Space>
    void build_grid(Space& space, automatic const& options) {
      if (!has_grid_) grid_.build(space, options.grid, mesh_);
      has_grid_ = true;
    }

    mesh_view<S> mesh_;
    bucket::index<S> grid_;
    all_pairs::index<S> bounds_;
    bvh::index<S> tree_;
    bool has_grid_ = false, has_bounds_ = false, has_tree_ = false;
    bool is_given_ = false;                    ///< made for a radius, or for steps, until the next build
    bool is_compact_ = false;                  ///< the mesh is known to have no long thin triangles
    bool is_planned_ = false;                  ///< the grid, for the spheres of this query
    strategy strategy_ = strategy::all_pairs;  ///< of this query
    tree_choices choices_;
    double spent_ = 0;           ///< nanoseconds that a grid would have saved so far
    double spent_on_boxes_ = 0;  ///< nanoseconds that a tree would have saved so far
  };
};

#if defined(COLLIDE_COMPILED)
COLLIDE_ELSEWHERE(automatic)
#endif

}  // namespace collide
