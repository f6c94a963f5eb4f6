/// \file
/// Sink: the nearest triangle of each point or sphere, at any distance.
#pragma once

#include <cstddef>
#include <limits>
#include <type_traits>

#include <collide/core/contact.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/karabassi.hpp>
#include <collide/narrow/detail/nearest_search.hpp>
#include <collide/sinks/detail/array_in_space.hpp>
#include <collide/sinks/detail/search_mesh.hpp>

namespace collide {

namespace detail {

/// How sure a narrow phase is which triangle is nearest.
template <class NarrowPhase>
struct nearest_precision {
  using type = exact;
};
template <class Precision>
struct nearest_precision<karabassi<Precision>> {
  using type = std::conditional_t<std::is_same<Precision, baseline>::value, single_precision, Precision>;
};

/// The nearest triangles of spheres in the parts of a mesh that have been searched so far: a plain value. What is kept
/// is alike in any order of the parts.
template <class S, class Precision>
struct nearest_so_far {
  S max_distance;
  sphere_view<S> spheres;
  nearest_triangle<S>* to;
  triangle<S>* corners;  ///< of those

  /// Looks at the nearest triangle of sphere `i` in a part.
  COLLIDE_HD void consider(std::size_t i, triangle<S> const& shape, id number) const {
    sphere<S> const s = spheres[i];
    nearest_search<S, Precision> best(s.centre, max_distance + s.radius);
    if (to[i].triangle != no_id) best.consider(corners[i], to[i].triangle);
    best.consider(shape, number);
    nearest_triangle<S> const result = best.result();
    if (result.triangle != number) return;
    to[i] = result;
    if (s.radius != 0) to[i].distance -= s.radius;
    corners[i] = shape;
  }
};

/// Kernel functor of `for_each` over spheres: takes what was found in a part.
template <class S, class Precision>
struct join_nearest {
  nearest_so_far<S, Precision> so_far;
  mesh_subset<S> part;
  nearest_triangle<S> const* found;  ///< in the part
  bool is_first;                     ///< nothing was found before

  COLLIDE_HD void operator()(std::size_t i) const {
    id const t = found[i].triangle;
    if (is_first) so_far.to[i] = no_nearest_triangle<S>();
    if (t != no_id) so_far.consider(i, part.triangles[t], part.number_of[t]);
  }
};

template <class S>
struct find_nearest_foot;
template <class S>
struct measure_nearest_foot;

/// Search functor of `nearest` for each sphere.
template <class S, class Precision>
struct find_nearest {
  using join = join_nearest<S, Precision>;      ///< joins what it finds in the parts of a mesh,
  using so_far = nearest_so_far<S, Precision>;  ///< to this
  static constexpr bool is_exact = std::is_same<Precision, exact>::value;
  using search_pass = std::conditional_t<is_exact, find_nearest_foot<S>, void>;      ///< first kernel on a device
  using measure_pass = std::conditional_t<is_exact, measure_nearest_foot<S>, void>;  ///< second kernel

  S max_distance;
  nearest_triangle<S>* to;

  template <class Search>
  COLLIDE_HD void operator()(std::size_t i, sphere<S> const& s, mesh_view<S> const& mesh, Search const& search) const {
    set(i, s, searched(s, mesh, search).result());
  }
  template <class Search>
  COLLIDE_HD_INLINE nearest_search<S, Precision> searched(sphere<S> const& s, mesh_view<S> const& mesh,
                                                          Search const& search) const {
    nearest_search<S, Precision> best(s.centre, reach_of(s));
    search(best.squared_bound(), [&](id t) {
      best.consider(mesh[t], t);
      return best.squared_bound();
    });
    return best;
  }
  /// The distance up to which triangles count; negative for a sphere that has no radius.
  COLLIDE_HD_INLINE S reach_of(sphere<S> const& s) const {
    return is_valid_radius(s.radius) ? max_distance + s.radius : S(-1);
  }
  COLLIDE_HD_INLINE void set(std::size_t i, sphere<S> const& s, nearest_triangle<S> const& found) const {
    to[i] = found;
    if (found.triangle != no_id && s.radius != 0) to[i].distance -= s.radius;
  }

  /// The box of the points that search beyond the box of a mesh. Spheres, which may do so from farther away, count as
  /// points: they are only later in the order.
  aabb<float> searched_box(aabb<float> mesh) const {
    auto const reach = static_cast<float>(min(max_distance, S(std::numeric_limits<float>::max())));
    for (int k = 0; k < 3; ++k) {
      mesh.lower[k] -= reach;
      mesh.upper[k] += reach;
    }
    return mesh;
  }
};

/// Search functor: which triangle is nearest, and which foot.
template <class S>
struct find_nearest_foot {
  find_nearest<S, exact> nearest;

  template <class Search>
  COLLIDE_HD void operator()(std::size_t i, sphere<S> const& s, mesh_view<S> const& mesh, Search const& search) const {
    nearest.searched(s, mesh, search).keep(nearest.to[i]);
  }
};

/// Kernel functor of `for_each` over spheres: what `find_nearest_foot` leaves to do.
template <class S>
struct measure_nearest_foot {
  find_nearest<S, exact> nearest;
  mesh_view<S> mesh;
  sphere_view<S> spheres;

  COLLIDE_HD void operator()(std::size_t i) const {
    sphere<S> const s = spheres[i];
    vec3<double> direction;
    nearest.set(i, s,
                exact_nearest_search<S>::result_of(nearest.to[i], mesh, s.centre, nearest.reach_of(s), direction));
  }
};

}  // namespace detail

/// The nearest triangle of each point, wherever it is, and where on it: `nearest_triangle`, one for each point. Of
/// equally near ones it is that with the smallest id. `query` takes points, or spheres: of these it is the triangle
/// nearest to the centre, and `distance` is that from the surface, negative where the two touch. What is not finite, or
/// farther than the largest distance, has `no_id` and a distance of +infinity.
///
/// Which triangle is nearest is decided as the precision of the narrow phase says: with `karabassi<>`, which is exact,
/// as in real arithmetic. Needs a broad phase that finds what is near at any distance: `bvh`, or `all_pairs`. O(log
/// triangles) for a point near the mesh with `bvh`. `query` does not wait. `S` is the scalar of the detector. Memory:
/// an entry for each point.
template <class S = float>
class nearest : public detail::array_per_sphere<nearest_triangle<S>> {
 public:
  /// A mesh may be in parts: see `in_passes` and `distributed`.
  static constexpr bool joins_parts = true;

  /// Triangles count up to `max_distance` from a point, or the surface of a sphere, inclusive. Throws `error` if it is
  /// negative or NaN.
  explicit nearest(std::common_type_t<S> max_distance = std::numeric_limits<S>::infinity())
      : max_distance_{max_distance} {
    if (!(max_distance >= 0)) throw error("collide: nearest: the largest distance is negative or NaN");
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    static_assert(std::is_same<S, typename Query::scalar>::value,
                  "collide: nearest<S> must have the scalar type of the detector");
    using precision = typename detail::nearest_precision<typename Query::narrow_phase>::type;
    auto* const to = this->memory_for(space, query.spheres.size());
    detail::search_mesh(query, detail::find_nearest<S, precision>{max_distance_, to});
  }

 private:
  S max_distance_;
};

}  // namespace collide
