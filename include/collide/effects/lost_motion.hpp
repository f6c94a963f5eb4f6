/// \file
/// Effect: counts steps in which rounding swallows a particle's motion.
#pragma once

#include <collide/effects/effect.hpp>

namespace collide {

/// For how many steps so far the displacement was lost to rounding; see `lost_motion`.
struct lost_steps {
  template <class S>
  using value = std::uint32_t;
};

/// Counts, for each particle, the steps whose displacement, velocity times dt, is not 0 but too small to change any
/// coordinate: less than half a unit in the last place of the position. Such a particle does not move, whatever its
/// velocity, until dt is larger, the scene is nearer to the origin, or the scalar is double. What rests is not counted.
///
/// `lost_particles(simulation)` reads how many particles have lost a step, at any time between steps. `step` itself
/// does not wait. 4 bytes and one read and write per particle and step, in scenes that name it.
struct lost_motion {
  using reads = columns<position, velocity>;
  using writes = columns<lost_steps>;

  template <class Particle, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, S dt) const {
    bool wanted = false, moved = false;
    for (int k = 0; k < 3; ++k) {
      S const x = p[position{}][k], by = p[velocity{}][k] * dt;
      wanted = wanted || by != 0;
      moved = moved || x + by != x;
    }
    if (wanted && !moved) ++p[lost_steps{}];
  }
};

/// How many particles have lost the displacement of at least one step to rounding. Waits, and copies the column:
/// O(particles).
template <class Simulation>
std::size_t lost_particles(Simulation const& simulation) {
  std::size_t n = 0;
  for (std::uint32_t steps : simulation.template to_host<lost_steps>()) n += steps != 0;
  return n;
}

}  // namespace collide
