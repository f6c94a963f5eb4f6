/// \file
/// Broad phase: `all_pairs` or `bucket`, whichever the sizes of the scene make the faster one.
#pragma once

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>

namespace collide {

/// Broad phase: chooses for each query. Testing all pairs has next to nothing to build, and wins for few spheres as
/// long as no grid has been made; `bucket` wins for all else. Which it is follows from the numbers of triangles and
/// spheres alone, by the measured costs of the space (docs/development/benchmarks.md): the same calls always go the
/// same way, and the pairs are the same either way. The grid is made by `build` with a radius, and else by the first
/// query for which it pays, counting what the queries before it would have saved. Complexity and memory are those of
/// the chosen one. A simulation names `bucket` or `all_pairs` itself.
struct automatic {
  bucket grid;  ///< options of `bucket`, for where that is chosen

  template <class S>
  class index {
   public:
    template <class Space>
    void build(Space&, automatic const&, mesh_view<S> mesh) {
      mesh_ = mesh;
      has_grid_ = has_bounds_ = false;
      spent_ = 0;
    }

    /// Makes the grid.
    template <class Space>
    void prepare(Space& space, automatic const& options, S radius) {
      make_grid(space, options);
      grid_.prepare(space, options.grid, radius);
    }

    template <class Space, class Spheres>
    void prepare(Space& space, automatic const& options, Spheres const& spheres) {
      uses_grid_ = has_grid_ ||
                   (detail::fits_grid(mesh_.size(), options.grid.most_triangles) && wants_grid<Space>(spheres.size()));
      if (uses_grid_) {
        make_grid(space, options);
        grid_.prepare(space, options.grid, spheres);
      } else if (!has_bounds_) {
        bounds_.build(space, all_pairs(), mesh_);
        has_bounds_ = true;
      }
    }

    /// Makes room for queries of up to so many spheres.
    template <class Space>
    void reserve([[maybe_unused]] Space& space, [[maybe_unused]] std::size_t spheres) {
      if constexpr (detail::is_valid<detail::index_reserve, bucket::index<S>, Space>) grid_.reserve(space, spheres);
    }

    /// About how many hits the query has, if the grid can tell; else 0.
    template <class NarrowPhase, class Space>
    std::uint64_t expected_hits(Space& space, detail::sphere_view_for<NarrowPhase, S> const& spheres) {
      return uses_grid_ ? grid_.template expected_hits<NarrowPhase>(space, spheres) : 0;
    }

    template <class NarrowPhase, class Space, class Output>
    void query(Space& space, detail::sphere_view_for<NarrowPhase, S> const& spheres, Output const& output) {
      if (uses_grid_) {
        grid_.template query<NarrowPhase>(space, spheres, output);
      } else {
        bounds_.template query<NarrowPhase>(space, spheres, output);
      }
    }

    /// Width of the finest cells in use; 0 if there is no grid.
    template <class Space>
    double cell_width(Space& space) const {
      return has_grid_ ? grid_.cell_width(space) : 0.0;
    }

   private:
    template <class Space>
    bool wants_grid(std::size_t spheres) {
      constexpr broad_phase_cost_model c = broad_phase_costs<Space>::value;
      auto const n = static_cast<double>(spheres), triangles = static_cast<double>(mesh_.size());
      double const saved = n * (c.per_near_sphere_ns + c.per_pair_ns * triangles - c.per_sphere_ns);
      // as long as a query does not pay for the grid alone, nobody knows whether there will be another
      if (c.build_ns + c.per_triangle_ns * triangles < saved + spent_) return true;
      spent_ += saved > 0 ? saved : 0;
      return false;
    }

    template <class Space>
    void make_grid(Space& space, automatic const& options) {
      if (has_grid_) return;
      grid_.build(space, options.grid, mesh_);
      has_grid_ = true;
    }

    mesh_view<S> mesh_;
    bucket::index<S> grid_;
    all_pairs::index<S> bounds_;
    bool has_grid_ = false, has_bounds_ = false;
    bool uses_grid_ = false;  ///< for this query
    double spent_ = 0;        ///< nanoseconds that a grid would have saved so far
  };
};

#if defined(COLLIDE_COMPILED)
COLLIDE_ELSEWHERE(automatic)
#endif

}  // namespace collide
