/// \file
/// A sphere and a triangle in exact arithmetic: the last stage of a verdict, and depths without cancellation.
///
/// The closest point of a triangle is a corner, or the foot of a perpendicular inside an edge or inside the face. The
/// sphere touches the triangle if and only if one of these, where there is such a foot, is within the radius. With
/// everything relative to the centre, and so a corner v, an edge e from v, and the normal n:
///
///                foot is inside if                       squared distance
///     corner                                             v.v
///     edge       -v.e > 0 and (v + e).e > 0              |v x e|^2 / e.e
///     face       (v x e).n > 0 for all three edges       (v.n)^2 / n.n
///
/// All of these are sums of products of at most six differences of coordinates.
#pragma once

#include <collide/detail/geometry/closest_point.hpp>
#include <collide/detail/numeric/exact_products.hpp>

namespace collide::detail {

/// How a point lies to a sphere: the distance from the centre, and how deep that is inside.
struct gap {
  double distance, depth;
};

/// Finite coordinates and a finite radius, not below 0. The centre may be moved by a vector of `Moved` parts.
template <int Moved = 0>
class exact_triangle {
 public:
  template <class S>
  COLLIDE_HD exact_triangle(triangle<S> const& t, sphere<S> const& s) : exact_triangle(t, s, nullptr) {}

  template <class S>
  COLLIDE_HD exact_triangle(triangle<S> const& t, sphere<S> const& s, exact_number<Moved> const* moved)
      : radius_{decoded(s.radius)} {
    vec3<S> const* const corners[3] = {&t.a, &t.b, &t.c};
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        dyadic const from = decoded((*corners[i])[k]);
        exact_difference const corner(from, decoded(s.centre[k]));
        if constexpr (Moved == 0) {
          corner_[i][k] = corner;
        } else {
          corner_[i][k] = minus(corner, moved[k]);
        }
        edge_[i][k] = {decoded((*corners[(i + 1) % 3])[k]), from};
      }
    }
  }

  /// Relative to the centre.
  COLLIDE_HD exact_vector<2 + Moved> const& corner(int i) const { return corner_[i]; }
  /// From each corner to the next.
  COLLIDE_HD exact_vector<2> const& edge(int i) const { return edge_[i]; }
  COLLIDE_HD exact_difference const& radius() const { return radius_; }

  /// True if the ball touches the triangle.
  COLLIDE_HD bool in_reach() const {
    bool reached = false;
    for_each_foot([&](foot const& f) {
      reached = f.within();
      return reached;
    });
    return reached;
  }

  struct foot;

  /// The foot that is the closest point, and how it lies to the sphere. `l` is the same triangle in doubles,
  /// `normalised`, and `around` the square of its distance.
  COLLIDE_HD foot nearest(local_triangle<double> const& l, double around, gap& to_nearest) const {
    foot best{this, feature::vertex, 0};
    int found = 0;
    auto const offer = [&](foot const& f) {
      gap const there = f.measured();
      // each of the two has all its digits where it is the smaller one
      bool const nearer =
          there.depth > there.distance ? there.distance < to_nearest.distance : there.depth > to_nearest.depth;
      if (found++ == 0 || nearer) {
        best = f;
        to_nearest = there;
      }
      return false;
    };
    for_each_foot(offer, near_feet(l, around));
    if (found == 0) for_each_foot(offer);
    return best;
  }

  /// (b - a) x (c - a), but for its length.
  COLLIDE_HD vec3<double> normal() const {
    return direction([&](int k, auto const& add) { sum_cross(k, 1, edge_[0], edge_[1], add); });
  }

  /// A point of the triangle that may be the closest one: corner `index`, the foot on edge `index`, or that on the
  /// face.
  struct foot {
    exact_triangle const* of;
    feature kind;
    int index;

    /// Sums the squared distance, multiplied by `length`.
    template <class Add>
    COLLIDE_HD void distance_squared(int weight, Add const& add) const {
      auto const& v = of->corner_[index];
      auto const& e = of->edge_[index];
      if (kind == feature::vertex) {
        sum_dot(weight, v, v, add);
      } else if (kind == feature::edge) {
        sum_cross_squared(weight, v, e, add);
      } else {
        sum_determinant_squared(weight, v, e, of->edge_[1], add);
      }
    }

    /// Sums the squared length of the edge or of the normal, or 1, multiplied by the factors.
    template <class Add, class... Factors>
    COLLIDE_HD void length(int weight, Add const& add, Factors const&... factors) const {
      auto const& e = of->edge_[index];
      if (kind == feature::vertex) {
        add(weight, factors...);
      } else if (kind == feature::edge) {
        sum_dot(weight, e, e, add, factors...);
      } else {
        sum_cross_squared(weight, e, of->edge_[1], add, factors...);
      }
    }

    /// Sums what the square of the radius is above that of the distance, multiplied by `length`.
    template <class Add>
    COLLIDE_HD void excess(Add const& add) const {
      length(1, add, of->radius_, of->radius_);
      distance_squared(-1, add);
    }

    /// True if the ball reaches it.
    COLLIDE_HD bool within() const {
      return exact_sum::sign_of([&](auto const& add) { excess(add); }) >= 0;
    }

    /// The errors are a few units in the last place, however small the numbers are.
    COLLIDE_HD gap measured() const {
      exact_difference const one(dyadic{1, 0});
      wide_number const by = exact_sum::of([&](auto const& add) { length(1, add, one); });
      wide_number const d = root_of_distance_squared(by);
      double const distance = times_power(d.value, d.exponent);
      wide_number const above = exact_sum::of([&](auto const& add) { excess(add); });
      if (above.value == 0) return {distance, 0};
      // R - d = (R^2 - d^2) / (R + d), where R and d are divided by a power of two as large as the larger one
      dyadic const r = of->radius_.parts().count == 0 ? dyadic{0, 0} : of->radius_.parts()[0];
      int const top = r.mantissa == 0 ? d.exponent : larger(d.exponent, r.exponent + r.length());
      double const sum =
          times_power(static_cast<double>(r.mantissa), r.exponent - top) + times_power(d.value, d.exponent - top);
      double const depth = times_power(div(div(above.value, by.value), sum), above.exponent - by.exponent - top);
      double const radius = times_power(static_cast<double>(r.mantissa), r.exponent);
      return {distance, smaller(depth, radius)};  // rounding up from the largest number would make it infinite
    }

    /// From here to the centre, but for the length; 0 if the centre is here.
    COLLIDE_HD vec3<double> towards_centre() const {
      auto const& v = of->corner_[index];
      auto const& e = of->edge_[index];
      if (kind == feature::vertex) {
        return direction([&](int k, auto const& add) { add(-1, v[k]); });
      }
      if (kind == feature::edge) {  // e (v.e) - v (e.e)
        return direction([&](int k, auto const& add) {
          for (int i = 0; i < 3; ++i) {
            add(1, e[k], v[i], e[i]);
            add(-1, v[k], e[i], e[i]);
          }
        });
      }
      int const side = exact_sum::sign_of([&](auto const& add) { sum_determinant(1, v, e, of->edge_[1], add); });
      return of->normal() * -side;
    }

   private:
    /// The distance, if `by` is the denominator: a value between 1/2 and 2, or 0, times a power of two; that of 0 is
    /// below all others.
    COLLIDE_HD wide_number root_of_distance_squared(wide_number const& by) const {
      wide_number const square = exact_sum::of([&](auto const& add) { distance_squared(1, add); });
      if (square.value == 0) return {0, -4000};
      int const exponent = square.exponent - by.exponent, half = exponent / 2;
      return {root(times_power(div(square.value, by.value), exponent - 2 * half)), half};
    }
  };

 private:
  /// Calls f(foot) for every foot that there is, until it returns true.
  template <class F>
  COLLIDE_HD void for_each_foot(F const& f) const {
    for_each_foot(f, all_feet);
  }

  /// A bit for each corner, then for each edge, then for the face: whether to look at it.
  static constexpr unsigned all_feet = 0x7f;

  template <class F>
  COLLIDE_HD void for_each_foot(F const& f, unsigned wanted) const {
    for (int i = 0; i < 3; ++i) {
      if ((wanted >> i & 1) != 0 && f(foot{this, feature::vertex, i})) return;
    }
    for (int i = 0; i < 3; ++i) {
      if ((wanted >> (3 + i) & 1) != 0 && beside_edge(i) && f(foot{this, feature::edge, i})) return;
    }
    if ((wanted >> 6 & 1) != 0 && over_face()) f(foot{this, feature::face, 0});
  }

  /// The feet that are not certainly farther than the root of `around`, as far as doubles can tell.
  static COLLIDE_HD unsigned near_feet(local_triangle<double> const& l, double around) {
    double const reach = root(around) + 0x1p-40, limit = mul(mul(reach, reach), 1 + 0x1p-40);  // l is below 4
    vec3<double> const v[3] = {l.a, l.b, l.c};
    unsigned near = 1u << 6;
    for (int i = 0; i < 3; ++i) {
      vec3<double> const e = v[(i + 1) % 3] - v[i], c = detail::cross(v[i], e);
      double const ee = dot(e, e);
      if (dot(v[i], v[i]) <= limit) near |= 1u << i;
      if (dot(c, c) <= mul(limit, ee)) near |= 8u << i;
    }
    return near;
  }

  /// A vector of three exact sums, but for its length.
  template <class Component>
  static COLLIDE_HD vec3<double> direction(Component const& component) {
    wide_number w[3];
    int top = -(1 << 30);
    for (int k = 0; k < 3; ++k) {
      w[k] = exact_sum::of([&](auto const& add) { component(k, add); });
      if (w[k].value != 0) top = larger(top, w[k].exponent);
    }
    vec3<double> d;
    for (int k = 0; k < 3; ++k)
      d[k] = w[k].value == 0 ? 0 : times_power(w[k].value, larger(w[k].exponent - top, -2000));
    return d;
  }

  /// The centre projects into the edge.
  COLLIDE_HD bool beside_edge(int i) const {
    auto const along = [&](int corner, int weight) {
      return exact_sum::sign_of([&](auto const& add) { sum_dot(weight, corner_[corner], edge_[i], add); });
    };
    return along(i, -1) > 0 && along((i + 1) % 3, 1) > 0;
  }

  /// The centre projects into the face.
  COLLIDE_HD bool over_face() const {
    for (int i = 0; i < 3; ++i) {
      int const side = exact_sum::sign_of(
          [&](auto const& add) { sum_cross_dot_cross(1, corner_[i], edge_[i], edge_[0], edge_[1], add); });
      if (side <= 0) return false;
    }
    return true;
  }

  /// x * 2^n, also where 2^n is beyond the range.
  static COLLIDE_HD double times_power(double x, int n) {
    for (; n > 1000; n -= 1000) x *= 0x1p1000;
    for (; n < -1000; n += 1000) x *= 0x1p-1000;
    return x * from_bits<double>(static_cast<std::uint64_t>(n + 1023) << 52);
  }

  exact_vector<2 + Moved> corner_[3];
  exact_vector<2> edge_[3];
  exact_difference radius_;
};

}  // namespace collide::detail
