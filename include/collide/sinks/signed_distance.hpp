/// \file
/// Sink: how far each point is from the surface of a closed mesh, and on which side.
#pragma once

#include <cstddef>
#include <limits>
#include <type_traits>

#include <collide/exact/detail/geometry/local_triangle.hpp>
#include <collide/sinks/contains.hpp>
#include <collide/sinks/nearest.hpp>

namespace collide {

/// The nearest triangle of a closed mesh, with the side that the point is on: `distance` is negative inside and 0 on
/// the surface.
template <class S>
struct signed_nearest_triangle : nearest_triangle<S> {
  /// The gradient of the signed distance: a unit vector, from the surface to a point outside, and from a point inside
  /// to the surface. On the surface the normal (b - a) x (c - a) of the triangle; 0 if that is a segment or a point.
  vec3<S> gradient;
};

namespace detail {

/// Kernel functor of `for_each` over points: the nearest triangle of each, and on which side it is.
template <class S, class Precision>
struct find_signed_distance {
  S max_distance;
  signed_nearest_triangle<S>* to;

  template <class Search>
  COLLIDE_HD void operator()(std::size_t i, sphere<S> const& s, mesh_view<S> const& mesh, Search const& search) const {
    nearest_search<S, Precision> best(s.centre, max_distance);
    search(best.squared_bound(), [&](id t) {
      best.consider(mesh[t], t);
      return best.squared_bound();
    });
    vec3<double> direction{0, 0, 0};
    signed_nearest_triangle<S> found{best.result(direction), {0, 0, 0}};
    ray_parity<S> const parity = parity_of(s.centre, mesh, search);
    bool const inside = parity.inside() && !parity.on_surface();
    if (parity.on_surface()) found.distance = S(0);
    if (found.triangle == no_id) {
      found.gradient = found.point;  // NaN
    } else if (max_norm(direction) > 0) {
      found.gradient = rounded_to<S>(unit<double>(inside ? vec3<double>(-direction) : direction));
    }
    if (inside) found.distance = -found.distance;
    to[i] = found;
  }
};

}  // namespace detail

/// The nearest triangle of each point, with a distance that is negative inside a closed mesh, 0 on its surface and
/// positive outside: `signed_nearest_triangle`, one for each point. It is what `nearest` finds, with the side that
/// `contains` finds, which is exact whatever the precision; each says what it needs. Farther from the mesh than the
/// largest distance, where `triangle` is `no_id`, the distance is -infinity inside, else +infinity, and point and
/// gradient are NaN. Of spheres it is the distance of the centre.
///
/// `query` does not wait. `S` is the scalar of the detector. Memory: an entry for each point.
template <class S = float>
class signed_distance : public detail::array_per_sphere<signed_nearest_triangle<S>> {
 public:
  /// Triangles count up to `max_distance` from a point, inclusive. Throws `error` if it is negative or NaN.
  explicit signed_distance(std::common_type_t<S> max_distance = std::numeric_limits<S>::infinity())
      : max_distance_{max_distance} {
    if (!(max_distance >= 0)) throw error("collide: signed_distance: the largest distance is negative or NaN");
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    static_assert(std::is_same<S, typename Query::scalar>::value,
                  "collide: signed_distance<S> must have the scalar type of the detector");
    using precision = typename detail::nearest_precision<typename Query::narrow_phase>::type;
    auto* const to = this->memory_for(space, query.spheres.size());
    detail::search_mesh(query, detail::find_signed_distance<S, precision>{max_distance_, to});
  }

 private:
  S max_distance_;
};

}  // namespace collide
