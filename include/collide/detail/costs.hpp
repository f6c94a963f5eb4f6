/// \file
/// What the broad phases cost on an execution space: by this `automatic` chooses.
#pragma once

namespace collide::detail {

/// Nanoseconds, as measured by `bench/automatic_bench`; only their ratios count. Those of the CUDA spaces are of an
/// H100, those of the host of one thread of an AMD EPYC.
struct broad_phase_costs {
  double per_pair;      ///< `all_pairs`: a sphere and a triangle
  double per_sphere;    ///< `bucket`: a sphere
  double per_triangle;  ///< a triangle of the build
  double build;         ///< the build, however small the mesh
  double query;         ///< what a query takes longer than one of `all_pairs`, however few the spheres
};

}  // namespace collide::detail
