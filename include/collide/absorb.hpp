/// \file
/// Effects: sinks, in which particles vanish.
#pragma once

#include <collide/effect.hpp>

namespace collide {

/// Particles vanish where they touch the mesh. They keep their place in memory, with `present` 0, and cost next to
/// nothing.
struct absorb {
  using writes = columns<present>;

  template <class Particle>
  COLLIDE_HD_INLINE bool skips(Particle const& p) const {
    return p[present{}] == 0;
  }
  template <class Particle, class S>
  COLLIDE_HD_INLINE void touch(Particle& p, touching<S>&, S) const {
    p[present{}] = 0;
  }
};

/// Particles vanish where their centre is in a box at the end of a step.
struct absorb_in {
  using reads = columns<position>;
  using writes = columns<present>;

  double lower[3] = {0, 0, 0}, upper[3] = {0, 0, 0};

  template <class Particle>
  COLLIDE_HD_INLINE bool skips(Particle const& p) const {
    return p[present{}] == 0;
  }
  template <class Particle, class S>
  COLLIDE_HD_INLINE void finish(Particle& p, S) const {
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      S const x = p[position{}][k];
      inside = inside && x >= S(lower[k]) && x <= S(upper[k]);
    }
    if (inside) p[present{}] = 0;
  }
};

}  // namespace collide
