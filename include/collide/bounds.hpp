/// \file
/// Effects: a box that particles do not leave.
#pragma once

#include <limits>

#include <collide/detail/numeric/rounding.hpp>
#include <collide/effect.hpp>

namespace collide {

/// Walls of a box, which needs no mesh. A particle that is beyond a wall at the end of a step is put back to it, and
/// its velocity turns around, times `restitution`. An infinite bound is no wall.
struct box_walls {
  using writes = columns<position, velocity>;

  static constexpr double none = std::numeric_limits<double>::infinity();  ///< a bound that is no wall
  double lower[3] = {-none, -none, -none};  ///< the walls at the smallest coordinates; none is above that of `upper`
  double upper[3] = {none, none, none};     ///< the walls at the largest coordinates
  double restitution = 0.5;                 ///< speed after a bounce over speed before it, 0 to 1

  void check_parameters() const {
    for (int k = 0; k < 3; ++k)
      detail::check_parameter(lower[k] <= upper[k], "box_walls: no lower bound is above its upper bound");
    detail::check_parameter(restitution >= 0 && restitution <= 1, "box_walls: restitution is from 0 to 1");
  }

  template <class Particle, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, S) const {
    for (int k = 0; k < 3; ++k) {
      S& x = p[position{}][k];
      S& v = p[velocity{}][k];
      S const low = S(lower[k]) + p.radius(), high = S(upper[k]) - p.radius();
      if (x < low) {
        x = low;
        v = v < 0 ? -S(restitution) * v : v;
      } else if (x > high) {
        x = high;
        v = v > 0 ? -S(restitution) * v : v;
      }
    }
  }
};

/// A box that repeats: a particle that leaves on one side comes in on the other. Neither the mesh nor contacts between
/// spheres repeat.
struct periodic_box {
  using writes = columns<position>;

  double lower[3] = {0, 0, 0};  ///< the corner of the smallest coordinates; each is below that of `upper`
  double upper[3] = {1, 1, 1};  ///< the corner of the largest coordinates

  void check_parameters() const {
    for (int k = 0; k < 3; ++k)
      detail::check_parameter(lower[k] < upper[k], "periodic_box: each lower bound is below its upper bound");
  }

  template <class Particle, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, S) const {
    for (int k = 0; k < 3; ++k) {
      S& x = p[position{}][k];
      S const low = S(lower[k]), high = S(upper[k]);
      if (x < low) {
        x = detail::smaller(x + (high - low), high);
      } else if (x >= high) {
        x = detail::larger(x - (high - low), low);
      }
    }
  }
};

}  // namespace collide
