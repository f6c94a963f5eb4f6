/// \file
/// Integrators: which part of a step's acceleration comes before the way of the step, and which after.
#pragma once

namespace collide {

/// The default: all of it before, v += a dt, x += v dt. Of first order, symplectic.
struct semi_implicit_euler {
  static constexpr double kick_before = 1;  ///< the part of the acceleration before the particle moves
  static constexpr double kick_after = 0;   ///< the part of the acceleration after it has moved
};

/// Velocity Verlet: half before and half after, v += a dt/2, x += v dt, v += a dt/2. Of second order, symplectic.
/// Accelerations are computed twice per step, no memory is needed. Named in a scene's list, as an effect is:
/// `simulation<detector<bucket>, velocity_verlet, gravity, bounce>`.
struct velocity_verlet {
  static constexpr double kick_before = 0.5;  ///< the part of the acceleration before the particle moves
  static constexpr double kick_after = 0.5;   ///< the part of the acceleration after it has moved
};

}  // namespace collide
