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
/// Accelerations of single particles are computed twice per step; those by other particles once, where the particles
/// are then, with their velocities half a step before: kept in a column for the two halves. What the mesh holds gets
/// both halves at once, in the next step, which takes a byte a particle. Named in a scene's list, as an effect is:
/// `simulation<detector<bucket>, velocity_verlet, gravity, bounce>`.
/// W. C. Swope et al., "A computer simulation method for the calculation of equilibrium constants", Journal of Chemical
/// Physics 76, 1982.
struct velocity_verlet {
  static constexpr double kick_before = 0.5;  ///< the part of the acceleration before the particle moves
  static constexpr double kick_after = 0.5;   ///< the part of the acceleration after it has moved
};

}  // namespace collide
