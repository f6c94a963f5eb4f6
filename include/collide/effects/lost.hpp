/// \file
/// Effect: counts particles that are nowhere.
#pragma once

#include <collide/effects/effect.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>

namespace collide {

/// 1 once the particle's position or velocity has been NaN or infinite at the end of a step; see `lost`.
struct is_lost : detail::byte_column {};

/// Marks particles whose position or velocity is NaN or infinite at the end of a step. Such a particle touches nothing
/// from then on, neither the mesh nor others, and stays what it is; the others go on. `lost_count(simulation)` reads
/// how many there are, at any time between steps. `step` itself does not wait. A byte a particle, in scenes that name
/// it.
struct lost {
  using reads = columns<position, velocity>;
  using writes = columns<is_lost>;

  template <class Particle, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, S) const {
    if (!detail::is_finite(p[position{}]) || !detail::is_finite(p[velocity{}])) p[is_lost{}] = 1;
  }
};

/// How many particles `lost` has marked. Waits, and copies the column: O(particles).
template <class Simulation>
std::size_t lost_count(Simulation const& simulation) {
  std::size_t n = 0;
  for (std::uint8_t const one : simulation.template to_host<is_lost>()) n += one;
  return n;
}

}  // namespace collide
