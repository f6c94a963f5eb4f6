/// \file
/// The nearest of many triangles to a point, one triangle after the other.
#pragma once

#include <limits>
#include <type_traits>

#include <collide/detail/geometry/closest_point.hpp>
#include <collide/nearest_triangle.hpp>
#include <collide/precision.hpp>

namespace collide::detail {

/// A number that is not below `x`, in `S`, though subnormal numbers may be flushed to zero. `x` is not negative.
template <class S>
COLLIDE_HD_INLINE S rounded_up(double x) {
  constexpr double least = static_cast<double>(std::numeric_limits<S>::min());
  constexpr double most = static_cast<double>(std::numeric_limits<S>::max());
  double const above = larger(mul(x, 1 + 4 * static_cast<double>(ieee_traits<S>::unit_roundoff)), least);
  return above < most ? static_cast<S>(above) : std::numeric_limits<S>::infinity();
}

/// The nearest triangle seen so far to one point, decided as `Precision` says.
template <class S, class Precision>
class nearest_search {
 public:
  /// \param max_distance  the distance up to which triangles count, inclusive; not negative, or nothing counts
  COLLIDE_HD nearest_search(vec3<S> const& point, S max_distance) : point_(point), max_distance_(max_distance) {
    bool const valid = is_finite(point) && is_valid_radius(max_distance);
    distance_ = valid ? static_cast<double>(max_distance) : -1;
  }

  /// Looks at a triangle. Any order of triangles gives the same result; a triangle that is not finite is never nearest.
  COLLIDE_HD void consider(triangle<S> const& corners, id number) {
    if (distance_ < 0 || !is_finite(corners)) return;
    double const there = distance_to(corners);
    bool const nearer = there < distance_ || (there == distance_ && number < number_);
    if (!nearer) return;
    distance_ = there;
    corners_ = corners;
    number_ = number;
  }

  /// A box whose squared distance, rounded down, is above this holds no nearer triangle. Below 0 if nothing counts.
  COLLIDE_HD S squared_bound() const { return distance_ < 0 ? S(-1) : rounded_up<S>(mul(distance_, distance_)); }

  /// The nearest triangle.
  COLLIDE_HD nearest_triangle<S> result() const {
    constexpr S nan = std::numeric_limits<S>::quiet_NaN();
    if (number_ == no_id) {
      return {{nan, nan, nan}, {nan, nan, nan}, std::numeric_limits<S>::infinity(), no_id, feature::face, 0};
    }
    sphere<S> const centre{point_, 0};
    local_triangle<double> const l = to_unit_range(to_local<double>(corners_, centre), corners_, centre);
    closest_point<double> const foot = closest_to_origin(l, cross<double>(l.b - l.a, l.c - l.a));
    vec3<double> const at = point_.template cast<double>() + scaled(foot.point, div(1.0, l.scale));
    return {at.template cast<S>(),
            {nan, nan, nan},
            static_cast<S>(distance_),
            number_,
            foot.kind,
            static_cast<std::uint32_t>(foot.index)};
  }

 private:
  COLLIDE_HD double distance_to(triangle<S> const& t) const {
    sphere<S> const centre{point_, 0};
    local_triangle<double> const l = to_unit_range(to_local<double>(t, centre), t, centre);
    closest_point<double> const foot = closest_to_origin(l, cross<double>(l.b - l.a, l.c - l.a));
    return div(sqrt_rn(foot.distance_squared), l.scale);
  }

  vec3<S> point_;
  S max_distance_;
  double distance_;
  triangle<S> corners_;
  id number_ = no_id;
};

}  // namespace collide::detail
