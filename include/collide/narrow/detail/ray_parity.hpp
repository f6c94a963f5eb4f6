/// \file
/// The test if a point is inside a closed mesh: an odd number of triangles above it.
#pragma once

#include <collide/exact/detail/predicates/exact_ray.hpp>
#include <collide/narrow/detail/intersects.hpp>

namespace collide::detail {

/// Counts the triangles that the ray from a point along +z crosses: exactly, whatever the precision of the detector.
/// Triangles may come in any order, each once. Those whose box the ray does not meet may be left out: it meets one if
///
///     lower.x <= p.x <= upper.x,  lower.y <= p.y <= upper.y  and  p.z <= upper.z
template <class S>
class ray_parity {
 public:
  COLLIDE_HD explicit ray_parity(vec3<S> const& point) : point_(point), done_(!is_finite(point)) {}

  /// Looks at a triangle; one that is not finite is not there. False if nothing that is still to come makes a
  /// difference.
  COLLIDE_HD bool consider(triangle<S> const& t) {
    if (done_ || !box_meets_ray(t) || !is_finite(t)) return !done_;
    bool on_line;
    ray_crossing const crossing = cross(t, on_line);
    if (crossing == ray_crossing::above) odd_ = !odd_;
    // guard: ray-surface
    if (crossing == ray_crossing::at_point || (on_line && intersects_exact(t, sphere<S>{point_, 0}).hit))
      on_surface_ = done_ = true;
    return !done_;
  }

  /// True if the point is on a triangle.
  COLLIDE_HD bool on_surface() const { return on_surface_; }
  /// True if the point is inside or on the surface.
  COLLIDE_HD bool inside() const { return on_surface_ || odd_; }

 private:
  vec3<S> point_;
  bool odd_ = false, on_surface_ = false, done_;

  /// Comparisons in which subnormal numbers are taken for zero leave more to be looked at.
  COLLIDE_HD_INLINE bool box_meets_ray(triangle<S> const& t) const {
    auto const all_below = [&](int k) { return (t.a[k] < point_[k]) & (t.b[k] < point_[k]) & (t.c[k] < point_[k]); };
    auto const all_above = [&](int k) { return (t.a[k] > point_[k]) & (t.b[k] > point_[k]) & (t.c[k] > point_[k]); };
    return !(all_below(0) | all_above(0) | all_below(1) | all_above(1) | all_below(2));
  }

  COLLIDE_HD_NOINLINE ray_crossing cross(triangle<S> const& t, bool& on_line) const {
    return cross_ray(widened(t), widened(point_), on_line);
  }
};

}  // namespace collide::detail
