/// \file
/// The nearest of many triangles to a point, one triangle after the other.
#pragma once

#include <limits>
#include <type_traits>

#include <collide/core/contact.hpp>
#include <collide/core/precision.hpp>
#include <collide/mesh.hpp>
#include <collide/narrow/detail/contact_in_precision.hpp>
#include <collide/narrow/detail/distance_bounds.hpp>
#include <collide/narrow/detail/intersects.hpp>
#include <collide/narrow/detail/measure_nearest.hpp>

namespace collide::detail {

/// A number that is not below `x`, in `S`, though subnormal numbers may be flushed to zero. `x` is not negative.
template <class S>
COLLIDE_HD_INLINE S rounded_up(double x) {
  constexpr double smallest = static_cast<double>(std::numeric_limits<S>::min());
  constexpr double largest = static_cast<double>(std::numeric_limits<S>::max());
  double const above = max(mul_rn(x, 1 + 4 * static_cast<double>(ieee_traits<S>::unit_roundoff)), smallest);
  return above < largest ? static_cast<S>(above) : std::numeric_limits<S>::infinity();
}

template <class S>
COLLIDE_HD nearest_triangle<S> no_nearest_triangle() {
  constexpr S nan = std::numeric_limits<S>::quiet_NaN();
  return {{nan, nan, nan}, {nan, nan, nan}, std::numeric_limits<S>::infinity(), no_id, feature::face, 0};
}

/// A search that is exact: which triangle is nearest, whether it is within reach, and the feature; the distance is
/// within one unit in the last place.
///
/// Bounds of the distance of the nearest triangle so far are kept. Where they leave a comparison open, it is first
/// asked whether both closest features are one, where triangles share a corner or an edge; then integers decide.
template <class S>
class exact_nearest_search {
 public:
  COLLIDE_HD exact_nearest_search(vec3<S> const& point, S max_distance)
      : point_(point), max_distance_(max_distance), high_(-1) {
    if (is_finite(point) && is_valid_radius(max_distance)) high_ = max(widened(max_distance), 0.0);  // -0 is 0
  }

  COLLIDE_HD void consider(triangle<S> const& corners, id number) {
    distance_bounds found;
    if (high_ < 0 || number == number_ || !is_finite(corners) || !bound_distance(corners, point_, high_, found)) return;
    if (found.low > high_) return;
    bool nearer = number_ == no_id || found.high < low_;
    if (!nearer) {
      // guard: nearest-certain
      bool const tied = certain_ && found.certain && is_same_foot(corners_, foot_, corners, found.foot);
      int const order = tied ? 0 : compare(corners);
      // guard: nearest-tie
      nearer = order < 0 || (order == 0 && number < number_);
    }
    high_ = min(high_, found.high);
    if (!nearer) return;
    low_ = found.low;
    foot_ = found.foot;
    certain_ = found.certain;
    corners_ = corners;
    number_ = number;
  }

  COLLIDE_HD S squared_bound() const { return high_ < 0 ? S(-1) : rounded_up<S>(mul_rn(high_, high_)); }

  /// Keeps the triangle and its foot in members of a result. `result_of` makes the result of them.
  COLLIDE_HD void keep(nearest_triangle<S>& in) const {
    in.triangle = number_;
    in.feature_index = static_cast<std::uint32_t>(certain_ ? foot_ : unknown_foot);
  }
  COLLIDE_HD static nearest_triangle<S> result_of(nearest_triangle<S> const& kept, mesh_view<S> const& mesh,
                                                  vec3<S> const& point, S max_distance, vec3<double>& direction) {
    exact_nearest_search found(point, max_distance);
    found.number_ = kept.triangle;
    found.foot_ = static_cast<int>(kept.feature_index);
    found.certain_ = found.foot_ != unknown_foot;
    if (found.number_ != no_id) found.corners_ = mesh[found.number_];
    return found.result(direction);
  }

  /// The nearest triangle. `direction` is then set: from the closest point to the point, except for the length; on the
  /// triangle its normal, or 0.
  COLLIDE_HD nearest_triangle<S> result(vec3<double>& direction) const {
    // guard: nearest-reach
    if (number_ == no_id || !is_within_reach()) return no_nearest_triangle<S>();
    triangle<double> const t = widened(corners_);
    vec3<double> const p = widened(point_);
    // guard: nearest-projection
    int const foot = certain_ ? foot_ : closest_foot(t, p);
    measured_foot const there = measure_foot(t, p, foot);
    direction = there.direction;
    auto const weight = [&](int i) { return max(there.weight[i].high, 0.0); };
    return {rounded_to<S>(point_of_weights(t, there.weight)),
            rounded_to<S>({weight(0), weight(1), weight(2)}),
            rounded_distance(there.distance),
            number_,
            exact_triangle::feature_of(foot),
            static_cast<std::uint32_t>(exact_triangle::feature_index_of(foot))};
  }

 private:
  static constexpr int unknown_foot = 7;

  vec3<S> point_;
  S max_distance_;
  double low_ = 0,
         high_;  ///< bounds of the distance; without a triangle `high_` is the reach, below 0 if there is none
  int foot_ = 0;
  bool certain_ = false;  ///< the foot is exact
  triangle<S> corners_;
  id number_ = no_id;

  /// 0 only on the triangle, however small the distance is.
  static COLLIDE_HD S rounded_distance(double distance) {
    auto const rounded = static_cast<S>(distance);
    return rounded == 0 && distance > 0 ? std::numeric_limits<S>::denorm_min() : rounded;
  }

  COLLIDE_HD_NOINLINE int compare(triangle<S> const& with) const { return compare_distances(with, corners_, point_); }

  COLLIDE_HD bool is_within_reach() const {
    return is_infinite(max_distance_) || intersects_exact(corners_, sphere<S>{point_, max_distance_}).hit;
  }
};

/// A search in plain arithmetic of type `T`: the smallest of the distances as they are computed.
template <class S, class T>
class plain_nearest_search {
  using wide = std::common_type_t<S, T>;

 public:
  COLLIDE_HD plain_nearest_search(vec3<S> const& point, S max_distance) : point_(point), distance_(-1) {
    if (is_finite(point) && is_valid_radius(max_distance)) distance_ = max(static_cast<wide>(max_distance), wide(0));
  }

  COLLIDE_HD void consider(triangle<S> const& corners, id number) {
    if (distance_ < 0 || !is_finite(corners)) return;
    wide scale;
    closest_point<T> const foot = foot_on(local(corners, scale));
    wide const there = div_rn(static_cast<wide>(sqrt_rn(foot.distance_squared)), scale);
    if (!(there < distance_ || (there == distance_ && number < number_))) return;
    distance_ = there;
    corners_ = corners;
    number_ = number;
  }

  COLLIDE_HD S squared_bound() const {
    if (distance_ < 0) return S(-1);
    double const reach = mul_rn(static_cast<double>(distance_), 1 + 0x1p-12);  // a box may be nearer than was computed
    return rounded_up<S>(mul_rn(reach, reach));
  }

  COLLIDE_HD nearest_triangle<S> result(vec3<double>& direction) const {
    if (number_ == no_id) return no_nearest_triangle<S>();
    wide scale;
    local_triangle<T> const l = local(corners_, scale);
    vec3<T> const n = cross<T>(l.b - l.a, l.c - l.a);
    closest_point<T> const foot = closest_to_origin(l, n);
    direction = contact_normal(l, n, foot).template cast<double>();
    vec3<double> const at = point_.template cast<double>() +
                            scaled<double>(foot.point.template cast<double>(), div_rn(1.0, static_cast<double>(scale)));
    return {rounded_to<S>(at), rounded_to<S>(weights_of(l, n, foot)), static_cast<S>(distance_), number_,
            foot.kind,         static_cast<std::uint32_t>(foot.index)};
  }

 private:
  vec3<S> point_;
  wide distance_;  ///< without a triangle the reach, below 0 if there is none
  triangle<S> corners_;
  id number_ = no_id;

  COLLIDE_HD local_triangle<T> local(triangle<S> const& t, wide& scale) const {
    sphere<S> const centre{point_, 0};
    local_triangle<wide> const l = to_unit_range(to_local<wide>(t, centre), t, centre);
    scale = l.scale;
    return narrow_to<T>(l);
  }

  static COLLIDE_HD closest_point<T> foot_on(local_triangle<T> const& l) {
    return closest_to_origin(l, cross<T>(l.b - l.a, l.c - l.a));
  }

  static COLLIDE_HD vec3<double> weights_of(local_triangle<T> const& l, vec3<T> const& n,
                                            closest_point<T> const& foot) {
    vec3<double> weight{0, 0, 0};
    if (foot.kind == feature::vertex) {
      weight[foot.index] = 1;
    } else if (foot.kind == feature::edge) {
      vec3<T> const from = foot.index == 0 ? l.a : (foot.index == 1 ? l.b : l.c);
      vec3<T> const e = (foot.index == 0 ? l.b : (foot.index == 1 ? l.c : l.a)) - from;
      auto const along = static_cast<double>(div_rn(-dot(from, e), dot(e, e)));
      weight[foot.index] = 1 - along;
      weight[(foot.index + 1) % 3] = along;
    } else {
      T const a = dot(cross(l.b, l.c), n), b = dot(cross(l.c, l.a), n), c = dot(cross(l.a, l.b), n), sum = a + b + c;
      weight = {static_cast<double>(div_rn(a, sum)), static_cast<double>(div_rn(b, sum)),
                static_cast<double>(div_rn(c, sum))};
    }
    return weight;
  }
};

/// The nearest triangle seen so far to one point, decided as `Precision` says. Triangles may come in any order: with
/// `exact` it makes no difference.
///
///     nearest_search(point, max_distance)    triangles count up to that distance, inclusive; none if it is below 0
///     consider(corners, number)              looks at a triangle, which may come again; one that is not finite is
///                                            never nearest
///     squared_bound()                        a box whose squared distance, rounded down, is above this holds no nearer
///                                            triangle; below 0 if no triangle counts
///     result()                               the nearest triangle, of equally near ones the one of the lowest number
template <class S, class Precision>
class nearest_search : public std::conditional_t<std::is_same<Precision, exact>::value, exact_nearest_search<S>,
                                                 plain_nearest_search<S, typename Precision::scalar>> {
  using base = std::conditional_t<std::is_same<Precision, exact>::value, exact_nearest_search<S>,
                                  plain_nearest_search<S, typename Precision::scalar>>;

 public:
  using base::base;

  COLLIDE_HD nearest_triangle<S> result() const {
    vec3<double> direction;
    return base::result(direction);
  }
  using base::result;
};

}  // namespace collide::detail
