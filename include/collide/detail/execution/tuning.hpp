/// \file
/// What the broad phases cost on an execution space: by this `automatic` chooses.
#pragma once

namespace collide::detail {

/// Nanoseconds, as measured by `bench/automatic_bench`; only their ratios count. Those of the CUDA spaces are of an
/// H100, those of the host of one thread of an AMD EPYC.
struct broad_phase_costs {
  double near;          ///< `all_pairs`: a sphere and the few triangles that it is near to
  double per_pair;      ///< `all_pairs`: a sphere and any triangle
  double per_sphere;    ///< `bucket`: a sphere
  double per_triangle;  ///< a triangle of the build
  double build;         ///< the build, however small the mesh
};

}  // namespace collide::detail
