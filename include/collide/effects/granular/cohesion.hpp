/// \file
/// Cohesion: forces that pull grains together.
#pragma once

#include <limits>

#include <collide/effects/granular/law.hpp>

namespace collide {

/// A pull of `cohesion` times the area in which two spheres overlap, 2 pi overlap 2 R*: the simplified JKR model of
/// LIGGGHTS, second form (`sjkr2`). Friction has the limits that it has without the pull.
struct sjkr {
  static constexpr bool is_mutual = true;  ///< see law.hpp
  double wall_factor = 0.5;                ///< of 4 pi R overlap at walls, not negative; LIGGGHTS: 0.5

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(wall_factor), "sjkr: wall_factor is not negative, and finite");
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE void pull(normal_force<S>& n, granular_pair<S> const& p, detail::contact_material const& m,
                              Memory const&) const {
    S const factor = p.is_wall ? S(12.566370614359172 * wall_factor) : S(12.566370614359172);
    S const pull = S(m.cohesion) * factor * p.radius * detail::max(p.overlap, S(0));
    n.elastic -= pull;
    n.pull_off = pull / 2;
  }
};

/// Hertz' force less a constant pull, 4 pi gamma R*, of hard grains: B. V. Derjaguin, V. M. Muller and Y. P. Toporov,
/// Journal of Colloid and Interface Science 53, 1975.
struct dmt {
  static constexpr bool is_mutual = true;          ///< see law.hpp
  static constexpr bool needs_hertz = true;        ///< the normal law must be `hertz`
  static constexpr double farthest_saddle = 1e-3;  ///< from a sphere, in its radii, so that a shallow fold is a plane

  /// The least overlap that holds.
  template <class S>
  COLLIDE_HD_INLINE S min_overlap(granular_pair<S> const&, detail::contact_material const&) const {
    return std::numeric_limits<S>::min();
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE void pull(normal_force<S>& n, granular_pair<S> const& p, detail::contact_material const& m,
                              Memory const&) const {
    n.pull_off = S(12.566370614359172) * S(m.cohesion) * p.radius;
    n.elastic -= n.pull_off;
  }
};

/// Soft grains that stick: K. L. Johnson, K. Kendall and A. D. Roberts, Proceedings of the Royal Society A 324, 1971.
/// With x^2 = a, the overlap is x^4 / R* - 2 x sqrt(pi gamma / E*), and the force 4 E* a^3 / (3 R*) - 4 sqrt(pi gamma
/// E* a^3). They hold each other by up to 3 pi gamma R*, also a little apart, once they have touched: up to 1.19 R* (pi
/// gamma / (E* R*))^(2/3), where they jump apart if they are moved (fixed grips), as of C. Thornton and Z. Ning, Powder
/// Technology 99, 1998. LAMMPS parts them where the pull is largest, 3 pi gamma R*, at about half that distance, so
/// that slow impacts stick less there. Farther apart than a twentieth of its radius a sphere loses a wall.
struct jkr {
  static constexpr bool is_mutual = true;             ///< see law.hpp
  using remembers = contact_columns<contact_radius>;  ///< so that a contact goes on where the two are apart
  static constexpr double farther = 0.05;             ///< than its radius a sphere sees the mesh, in radii
  static constexpr double farthest_saddle = farther + dmt::farthest_saddle;  ///< from a sphere, in its radii
  static constexpr bool needs_hertz = true;                                  ///< the normal law must be `hertz`

  template <class S, class Memory>
  COLLIDE_HD_INLINE void pull(normal_force<S>& n, granular_pair<S> const& p, detail::contact_material const& m,
                              Memory const&) const {
    S const gamma = S(m.cohesion), young = S(m.young);
    if (!detail::any(gamma > 0)) return;
    S const k = detail::sqrt_rn(S(3.141592653589793) * gamma / young);
    auto const larger_root = [](auto r, auto of, auto overlap) { return root(r, of, overlap); };
    S const x = detail::in_each_lane(larger_root, p.radius, k, p.overlap);
    auto const touches = x > 0;  // else they have parted
    S const a = x * x, cube = a * a * a;
    n.contact_radius = detail::either(touches, a, S(0));
    n.stiffness = detail::either(touches, S(2 * young * a), S(0));
    n.elastic =
        detail::either(touches, S(S(4.0 / 3) * young * cube / p.radius - 4 * k * young * detail::sqrt_rn(cube)), S(0));
    n.pull_off = detail::either(touches, S(S(9.42477796076938) * gamma * p.radius), n.pull_off);
    n.goes_on = touches;
  }

  /// The least overlap that holds: -3/2 k x with x^3 = k R* / 2 and k^2 = pi gamma / E*, less what rounding takes.
  template <class S>
  COLLIDE_HD_INLINE S min_overlap(granular_pair<S> const& p, detail::contact_material const& m) const {
    S const k = detail::sqrt_rn(S(3.141592653589793) * S(m.cohesion) / S(m.young)), cube = k * p.radius / 2;
    if (!(cube > 0)) return 0;
    S x = detail::max(detail::sqrt_rn(p.radius), k);  // above the root, to which Newton's method descends
    COLLIDE_NO_UNROLL
    for (S next; (next = (2 * x + cube / (x * x)) / 3) < x;) x = next;
    return S(-1.5) * k * x * (1 - 16 * std::numeric_limits<S>::epsilon());
  }

 private:
  /// The larger root of x^4 / r - 2 k x = overlap, by Newton's method from above; 0 if there is none: the two have
  /// parted.
  template <class S>
  static COLLIDE_HD_INLINE S root(S r, S k, S overlap) {
    S x = detail::sqrt_rn(detail::sqrt_rn(r * detail::max(overlap, S(0))));
    S lower = detail::sqrt_rn(detail::sqrt_rn(k * r));  // grows until it is above the root
    x = detail::max(x, lower);
    while (x * x * x * x / r - 2 * k * x < overlap) x *= 2;
    COLLIDE_NO_UNROLL
    for (int i = 0; i < 60; ++i) {
      S const slope = 4 * x * x * x / r - 2 * k;
      if (!(slope > 0)) return 0;
      S const next = x - (x * x * x * x / r - 2 * k * x - overlap) / slope;
      if (!(next < x)) return x;
      x = next;
    }
    return x;
  }
};

}  // namespace collide
