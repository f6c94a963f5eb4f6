/// \file
/// Sink: which points are inside a closed mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/predicates/exact_ray.hpp>
#include <collide/narrow/detail/intersects.hpp>
#include <collide/sinks/detail/array_in_space.hpp>
#include <collide/sinks/detail/search_mesh.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide {

namespace detail {

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
    bool on_line = false;
    ray_crossing crossing;
    if (!cross_ray_in_double(t, point_, crossing)) crossing = cross(t, on_line);
    if (crossing == ray_crossing::above) odd_ = !odd_;
    // guard: ray-surface
    if (crossing == ray_crossing::at_point || (on_line && intersects_exact(t, sphere<S>{point_, 0}).hit))
      on_surface_ = done_ = true;
    return !done_;
  }

  COLLIDE_HD ray_parity const& result() const { return *this; }
  /// Takes a triangle that has been looked at: it is crossed above the point, or nowhere.
  COLLIDE_HD_INLINE void add(bool crossed) { odd_ = odd_ != crossed; }

  /// True if the point is on a triangle.
  COLLIDE_HD bool on_surface() const { return on_surface_; }
  /// True if the point is inside or on the surface.
  COLLIDE_HD bool inside() const { return on_surface_ || odd_; }

 private:
  vec3<S> point_;
  bool odd_ = false, on_surface_ = false, done_;

  /// Comparisons in which subnormal numbers are taken for zero leave more to be looked at.
  COLLIDE_HD_INLINE bool box_meets_ray(triangle<S> const& t) const {
    auto const all_below = [&](int k) {
      return unsigned{t.a[k] < point_[k]} & unsigned{t.b[k] < point_[k]} & unsigned{t.c[k] < point_[k]};
    };
    auto const all_above = [&](int k) {
      return unsigned{t.a[k] > point_[k]} & unsigned{t.b[k] > point_[k]} & unsigned{t.c[k] > point_[k]};
    };
    return (all_below(0) | all_above(0) | all_below(1) | all_above(1) | all_below(2)) == 0;
  }

  COLLIDE_HD_NOINLINE ray_crossing cross(triangle<S> const& t, bool& on_line) const {
    return cross_ray(widened(t), widened(point_), on_line);
  }
};

#if !defined(__CUDA_ARCH__)

/// `ray_parity` of triangles that wait until there are as many as lanes in the vector unit.
template <class S>
class ray_parity_in_lanes {
 public:
  explicit ray_parity_in_lanes(vec3<S> const& point) : parity_(point), point_(point) {}

  bool consider(triangle<S> const& t) {
    // the first one is in all lanes, so that none is without
    if (waiting_ == 0) {
      for (int k = 0; k < width; ++k) put(k, t);
    } else {
      put(waiting_, t);
    }
    return ++waiting_ < width || look();
  }

  /// The parity of all that were considered.
  ray_parity<S> const& result() {
    if (waiting_ > 0) look();
    return parity_;
  }

 private:
  static constexpr int width = 8;

  alignas(32) S corners_[9][width];
  ray_parity<S> parity_;
  vec3<S> point_;
  int waiting_ = 0;

  COLLIDE_HD_INLINE void put(int k, triangle<S> const& t) {
    for (int i = 0; i < 3; ++i) corners_[i][k] = t.a[i], corners_[3 + i][k] = t.b[i], corners_[6 + i][k] = t.c[i];
  }
  COLLIDE_HD_INLINE triangle<S> waiting(int k) const {
    return {{corners_[0][k], corners_[1][k], corners_[2][k]},
            {corners_[3][k], corners_[4][k], corners_[5][k]},
            {corners_[6][k], corners_[7][k], corners_[8][k]}};
  }

  bool look() {
    bool goes_on = true;
    std::int32_t crossed[width];
    multiversioned([&] {
      for (int k = 0; k < width; ++k) crossed[k] = cross_ray_in_lane(waiting(k), point_[0], point_[1], point_[2]);
    });
    for (int k = 0; k < waiting_; ++k) {
      if (crossed[k] < 0) {
        goes_on = parity_.consider(waiting(k));
      } else {
        parity_.add(crossed[k] != 0);
      }
    }
    waiting_ = 0;
    return goes_on;
  }
};

#endif

/// The parity that tells if a point is inside the mesh. `Search` is a `mesh_search`.
template <class S, class Search>
COLLIDE_HD ray_parity<S> parity_of(vec3<S> const& point, mesh_view<S> const& mesh, Search const& search) {
  COLLIDE_ON_DEVICE(ray_parity<S>, ray_parity_in_lanes<S>) parity(point);
  search.on_ray([&](id t) { return parity.consider(mesh[t]); });
  return parity.result();
}

/// Search functor of `contains` for each point.
struct find_inside {
  std::uint8_t* to;

  template <class S, class Search>
  COLLIDE_HD void operator()(std::size_t i, sphere<S> const& s, mesh_view<S> const& mesh, Search const& search) const {
    to[i] = parity_of(s.centre, mesh, search).inside() ? 1 : 0;
  }

  /// The box of the points whose ray along +z may meet a mesh in a box.
  aabb<float> searched_box(aabb<float> mesh) const {
    mesh.lower[2] = -std::numeric_limits<float>::infinity();
    return mesh;
  }
};

}  // namespace detail

/// A flag per point: 1 if it is inside the mesh or on its surface, else 0. Of spheres it is that of the centre. A point
/// that is not finite is outside.
///
/// A point is inside if a ray from it crosses the mesh an odd number of times: exactly, whatever the precision of the
/// narrow phase, and with no special case for rays through edges and corners. Of a closed mesh that is the inside,
/// however its triangles are oriented, and triangle soups are meshes whose corners are one where their coordinates are
/// equal. Where a mesh is not closed the result depends on which way the ray goes, along +z: see `validate_closed`, and
/// `winding_number`.
///
/// Needs a broad phase that finds what is above a point: `bvh`, or `all_pairs`. O(triangles above or below the point)
/// with `bvh`, and more where these are near each other. `query` does not wait for the flags. Memory: one byte per
/// point.
class contains : public detail::array_per_sphere<std::uint8_t> {
 public:
  /// The flags are kept in memory of the space.
  contains() = default;
  /// The flags are written to the caller's memory (of the space), one byte per point: 0 or 1, for all points of the
  /// query. It must have room for them, and stay valid as long as this object is used.
  explicit contains(std::uint8_t* flags) : array_per_sphere{flags} {}

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    detail::search_mesh(query, detail::find_inside{memory_for(space, query.spheres.size())});
  }
};

}  // namespace collide
