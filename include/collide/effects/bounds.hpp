/// \file
/// Effects: a box that particles do not leave.
#pragma once

#include <limits>

#include <collide/effects/effect.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/repeating_box.hpp>

namespace collide {

/// Walls of a box, which needs no mesh. A particle that has gone through a wall in a step bounces off it: it is as far
/// inside as it was outside, times `restitution`, with the speed of the impact, times `restitution`, and what forces do
/// on the way back. So an elastic bounce loses or gains no energy, with either integrator. One that would be over
/// within six steps is none: the particle rests at the wall. An infinite bound is no wall.
struct box_walls {
  using optional_reads = columns<radius>;
  using writes = columns<position, velocity>;
  using optional_writes = columns<in_contact>;
  static constexpr bool asks_forces = true;

  static constexpr double none = std::numeric_limits<double>::infinity();  ///< a bound that is no wall
  double lower[3] = {-none, -none, -none};  ///< the walls at the smallest coordinates; none is above that of `upper`
  double upper[3] = {none, none, none};     ///< the walls at the largest coordinates
  double restitution = 0.5;                 ///< speed after a bounce over speed before it, 0 to 1

  void check_parameters() const {
    for (int k = 0; k < 3; ++k) {
      detail::check_parameter(lower[k] <= upper[k], "box_walls: no lower bound is above its upper bound");
      detail::check_parameter(lower[k] < none && upper[k] > -none,
                              "box_walls: no lower bound is infinite, and no upper bound minus infinite");
    }
    detail::check_parameter(restitution >= 0 && restitution <= 1, "box_walls: restitution is from 0 to 1");
  }

  template <class Particle, class Forces, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, Forces const& forces, S dt) const {
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      S& x = p[position{}][k];
      S const low = S(lower[k]) + p.radius(), high = S(upper[k]) - p.radius();
      if constexpr (Particle::template has<in_contact>) {
        if (x < low || x > high) p[in_contact{}] = 1;
      }
      if (x < low) {
        x = detail::min(reflect(p, k, S(1), low - x, forces, dt) + low, detail::max(low, high));
      } else if (x > high) {
        x = detail::max(high - reflect(p, k, S(-1), x - high, forces, dt), detail::min(low, high));
      }
    }
  }

 private:
  /// Turns a coordinate of the velocity around that points into the box along `inward`, of a particle that is outside
  /// by `depth`. Returns how far inside it is then. Both integrators keep v^2 / 2 - a x / dt for the velocity v in the
  /// middle of a step, if half the step's acceleration a is added to it.
  template <class Particle, class Forces, class S>
  COLLIDE_HD_INLINE S reflect(Particle& p, int k, S inward, S depth, Forces const& forces, S dt) const {
    S const e = S(restitution), a = inward * forces.change(dt)[k], late = Forces::kick_after * a;
    S const v = inward * p[velocity{}][k] - late;
    if (!(v < 0)) return S(0);
    S const fraction = detail::min(depth / (-v * dt), S(1)), there = v + a / 2, lift = -2 * a * v * fraction;
    S const speed = e * detail::sqrt_rn(there * there + lift);  // after the impact, at the wall
    bool const rests = speed <= -3 * a;
    S const square = speed * speed + e * lift;  // 0 or less: it does not come as high
    S const leaves = square > 0 ? detail::sqrt_rn(square) : speed;
    p[velocity{}][k] = rests ? S(0) : inward * (leaves - a / 2 + late);
    return rests || !(square > 0) ? S(0) : e * fraction * -v * dt;
  }
};

/// A box that repeats: a particle that leaves on one side comes in on the other, however far it is outside. At the end
/// of a step each coordinate is in [lower, upper). Particles meet across its sides as they do inside, with forces,
/// memory and sleep; each side must be 4.42 of the largest radii long then, or 4 and a little where others are much
/// smaller: `step` throws `error` if it is not. The mesh does not repeat: what stuck to it where it left is free.
///
/// If two meet across a side, effects see the one at the upper side where it is a length farther down: both the same.
struct periodic_box {
  using writes = columns<position>;
  using optional_writes = columns<adhered>;
  static constexpr bool repeats_space = true;  ///< particles meet across its sides

  double lower[3] = {0, 0, 0};  ///< the corner of the smallest coordinates; finite, each below that of `upper`
  double upper[3] = {1, 1, 1};  ///< the corner of the largest coordinates, finite

  void check_parameters() const {
    detail::check_parameter(detail::is_finite(lower) && detail::is_finite(upper),
                            "periodic_box: the bounds are finite");
    for (int k = 0; k < 3; ++k)
      detail::check_parameter(lower[k] < upper[k], "periodic_box: each lower bound is below its upper bound");
  }

  template <class Particle, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, S) const {
    for (int k = 0; k < 3; ++k) {
      S& x = p[position{}][k];
      S const low = S(lower[k]), high = S(upper[k]);
      if (!(x < low || x >= high)) continue;
      x = detail::wrapped(x, low, high);
      if constexpr (Particle::template has<adhered>) p[adhered{}] = 0;
    }
  }
};

}  // namespace collide
