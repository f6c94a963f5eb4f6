/// \file
/// The numbers by which the library is tuned for an execution space: traits, of which a space has to know nothing. The
/// defaults follow from where its memory is; specialise a trait for a space that wants other numbers.
#pragma once

#include <cstddef>

namespace collide {

/// Costs of the cells of `bucket`, in nanoseconds; only the ratios count.
struct bucket_costs {
  float entry_ns;       ///< to enter a triangle into a cell
  float candidate_ns;   ///< to look at a triangle that is in a sphere's cell
  float level_ns;       ///< to look into another cell, of another level, for each sphere
  float step_ns;        ///< to go on by the width of a cell on the way of a sphere that moves
  float serial_ns;      ///< to enter the largest triangle into another cell, which one block does while others are done
  float thin_ns;        ///< to look closer at a triangle that fills a small part of its box
  float thin_entry_ns;  ///< to enter such a triangle, more than another
  float waiting;        ///< the slowest thread takes as long as all do for so many spheres
};

/// How `bucket` works on a host: one core after the other waits for the memory.
struct host_bucket_tuning {
  static constexpr bucket_costs costs{30, 0.3f, 10, 3, 0, 6, 120, 0};
  /// True if many spheres are sorted into the cells, and triangles look for them, rather than the other way round.
  /// Needs memory that the host can access, and blocks of one thread with 64 items.
  static constexpr bool bins_spheres = true;
};

/// How `bucket` works on a device, with many threads.
struct device_bucket_tuning {
  static constexpr bucket_costs costs{0.12f, 0.004f, 0.06f, 0.04f, 7, 0, 0, 16384};
  static constexpr bool bins_spheres = false;
};

namespace detail {

template <bool HostAccessible>
struct default_bucket_tuning : host_bucket_tuning {};
template <>
struct default_bucket_tuning<false> : device_bucket_tuning {};

}  // namespace detail

/// How `bucket` works in a space.
template <class Space>
struct bucket_tuning : detail::default_bucket_tuning<Space::host_accessible> {};

template <class Space>
struct bvh_tuning {
  /// True if triangles are divided by the areas of boxes, which takes longer and finds faster than to sort them, and is
  /// for hosts. Needs memory that the host can access.
  static constexpr bool divides_by_area = Space::host_accessible;
  /// How many points are sorted before they search a tree, so that neighbours search the same nodes; on the host, of a
  /// mesh of how many triangles.
  static constexpr std::size_t min_sorted_points = std::size_t{1} << (Space::host_accessible ? 12 : 18),
                               min_triangles_to_sort = 4096;
};

namespace detail {

/// True for a space as a simulation shows it to a broad phase: what is made of a mesh serves many steps.
template <class Space>
inline constexpr bool serves_steps = false;

}  // namespace detail

/// How a query works in a space.
template <class Space>
struct query_tuning {
  /// True if a pair that takes long to decide is listed, and decided in a kernel of its own, as its neighbours in a
  /// block would wait for it.
  static constexpr bool defers_exact_tests = !Space::host_accessible;
};

/// Costs of the broad phases, in nanoseconds, as `bench/automatic_bench` measures them; only the ratios count.
struct broad_phase_cost_model {
  double per_near_ns;       ///< `all_pairs`: a sphere and a triangle that it is near to
  double per_pair_ns;       ///< `all_pairs`: a sphere and any triangle
  double per_sphere_ns;     ///< `bucket`: a sphere
  double per_triangle_ns;   ///< `bucket`: a triangle of the build
  double build_ns;          ///< `bucket`: the build, however small the mesh
  double per_bound_ns = 0;  ///< `all_pairs`: a triangle of the build
  double together = 1;      ///< `all_pairs`: as many spheres take as long as one
};

/// Costs of queries of long thin triangles, in nanoseconds, on one core of an AMD EPYC; only the ratios count.
struct tree_cost_model {
  double per_triangle_ns;     ///< `bucket`: a triangle of the mesh
  double per_box_ns;          ///< `bucket`: a sphere and a triangle whose box it reaches, and which is in its cell
  double per_sphere_ns;       ///< `bvh`: a sphere
  double per_touched_ns;      ///< `bvh`: a sphere and a triangle that it touches
  double per_piece_ns;        ///< `bvh`: a sphere and a triangle of which it reaches but the box of a piece
  double per_built_piece_ns;  ///< `bvh`: a piece of the build
};

/// By what `automatic` chooses between `bucket` and `bvh` where triangles are long and thin. It does so in spaces where
/// `bvh` divides by area.
inline constexpr tree_cost_model tree_costs{26, 16, 70, 30, 34, 450};
/// By what it chooses in a simulation, for its steps, however long the build takes.
inline constexpr tree_cost_model tree_costs_of_steps{0, 50, 500, 400, 0, 0};

/// By what `automatic` chooses in a space. The default is one thread of an AMD EPYC, or `cuda_shared` on an H100.
template <class Space>
struct broad_phase_costs {
  static constexpr broad_phase_cost_model value = Space::host_accessible
                                                      ? broad_phase_cost_model{80, 0.137, 4, 30, 5000, 13, 64}
                                                      : broad_phase_cost_model{0, 1.9, 0.012, 0.1, 30000};
};

namespace detail {

/// A space as a broad phase sees it that is asked for the triangles near single spheres: they are sorted, not the
/// spheres, and into narrow cells, as a look-up is cheap and a candidate is not.
template <class Space>
struct lookup_space : Space {};

template <class Space>
inline constexpr bool serves_steps<lookup_space<Space>> = true;

}  // namespace detail

template <class Space>
struct bucket_tuning<detail::lookup_space<Space>> : bucket_tuning<Space> {
  static constexpr bool bins_spheres = false;
  /// The grid serves many steps. On a device narrower cells gain nothing: their bits take more memory.
  static constexpr bucket_costs costs = [] {
    bucket_costs c = bucket_tuning<Space>::costs;
    if (Space::host_accessible) c.entry_ns /= 16;
    c.thin_ns = c.thin_entry_ns = c.waiting = 0;
    return c;
  }();
};

template <class Space>
struct bvh_tuning<detail::lookup_space<Space>> : bvh_tuning<Space> {};

}  // namespace collide
