/// \file
/// The choice between a tree and a grid for a scene on the host: by a sample of its triangles and spheres.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/tree/triangle_pieces.hpp>
#include <collide/exact/detail/geometry/closest_point.hpp>
#include <collide/exact/detail/geometry/local_triangle.hpp>
#include <collide/exact/detail/geometry/swept_bounds.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

/// The mean numbers, for a sphere, of triangles whose box it reaches, and of those that it reaches itself.
struct reached_by_sphere {
  double boxes, triangles;
};

/// In place of spheres, if none are known yet: one in the middle of each triangle. A sample of them lies between the
/// triangles of a sample as large: each at one of these would stand for many that touch as many.
template <class S>
struct middles_as_spheres {
  mesh_view<S> mesh;
  S radius;

  std::size_t size() const { return mesh.size(); }
  sphere<S> operator[](std::size_t i) const {
    triangle<S> const t = mesh[(i + mesh.size() / 256) % mesh.size()];
    return {t.a / S(3) + t.b / S(3) + t.c / S(3), radius};
  }
};

/// Triangles of a mesh at equal distances in its order, and what they tell of a scene. They are as many in a large mesh
/// as in a small one, so all of this takes some microseconds, and spheres a tenth of a millisecond.
template <class S>
class sampled_triangles {
 public:
  explicit sampled_triangles(mesh_view<S> const& mesh) : all_{mesh.size()}, count_{0} {
    std::size_t const n = min(all_, std::size_t{most});
    double wasted = 0, surface = 0;
    for (std::size_t i = 0; i < n; ++i) {
      triangle<S> const t = mesh[all_ / n * i + all_ % n * i / n];
      triangle_shape const shape(t);
      if (!is_finite(t)) continue;
      wasted += shape.wasted();
      surface += shape.half_surface;
      triangles_[count_++] = t;
    }
    // more than that is cut into pieces
    are_slender_ = wasted > surface / 2 && is_finite(surface);
  }

  /// True if their boxes are mostly empty.
  bool are_slender() const { return are_slender_; }

  /// The mean of what spheres reach, at rest or in motion, from at most so many of them.
  template <class Spheres>
  reached_by_sphere reached(Spheres const& spheres, std::size_t most_spheres) const {
    std::size_t const n = min(spheres.size(), most_spheres);
    std::size_t boxes = 0, triangles = 0;
    for (std::size_t i = 0; i < n; ++i) {
      sphere<S> const s = swept_bounding_sphere(spheres[spheres.size() / n * i + spheres.size() % n * i / n]);
      if (!is_valid_radius(s.radius) || !is_finite(s.centre) || !is_finite(s.radius)) continue;
      for (int k = 0; k < count_; ++k) {
        if (!triangle_aabb_of(triangles_[k]).overlaps(s.centre, s.radius)) continue;
        ++boxes;
        if (distance_squared(triangles_[k], s) <= s.radius * s.radius) ++triangles;
      }
    }
    if (n == 0 || count_ == 0) return {0, 0};
    double const scale = static_cast<double>(all_) / (static_cast<double>(n) * count_);
    return {static_cast<double>(boxes) * scale, static_cast<double>(triangles) * scale};
  }

 private:
  static constexpr int most = 128;

  static S distance_squared(triangle<S> const& t, sphere<S> const& s) {
    local_triangle<S> const l = to_local<S>(t, s);
    return closest_to_origin(l, cross<S>(l.b - l.a, l.c - l.a)).distance_squared;
  }

  triangle<S> triangles_[most];
  std::size_t all_;  ///< of the mesh
  int count_;        ///< that are finite
  bool are_slender_;
};

}  // namespace collide::detail
