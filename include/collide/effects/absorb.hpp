/// \file
/// Effects: sinks, in which particles vanish.
#pragma once

#include <collide/effects/effect.hpp>

namespace collide {

/// Particles vanish where they touch the mesh. They keep their place in memory, with `alive` 0, and cost next to
/// nothing. A clump vanishes as a whole where one of its spheres touches the mesh.
struct absorb {
  using writes = columns<alive>;
  static constexpr bool sees_clumps = true;  ///< a clump as a whole

  template <class Particle>
  COLLIDE_HD_INLINE bool is_inactive(Particle const& p) const {
    return p[alive{}] == 0;
  }
  template <class Particle, class S>
  COLLIDE_HD_INLINE void on_mesh_contact(Particle& p, mesh_contact<S>&, S) const {
    p[alive{}] = 0;
  }
};

/// Particles vanish where their centre is in a box at the end of a step.
struct absorbing_box {
  using reads = columns<position>;
  using writes = columns<alive>;
  static constexpr bool sees_clumps = true;  ///< a clump as one sphere

  double lower[3] = {0, 0, 0};  ///< the corner of the smallest coordinates; not above `upper`
  double upper[3] = {0, 0, 0};  ///< the corner of the largest coordinates

  void check_parameters() const {
    detail::check_parameter(lower[0] <= upper[0] && lower[1] <= upper[1] && lower[2] <= upper[2],
                            "absorbing_box: no lower bound is above its upper bound");
  }

  template <class Particle>
  COLLIDE_HD_INLINE bool is_inactive(Particle const& p) const {
    return p[alive{}] == 0;
  }
  template <class Particle, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, S) const {
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      S const x = p[position{}][k];
      inside = inside && x >= S(lower[k]) && x <= S(upper[k]);
    }
    if (inside) p[alive{}] = 0;
  }
};

}  // namespace collide
