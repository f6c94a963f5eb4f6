/// \file
/// Effect: particles stick to the mesh.
#pragma once

#include <limits>

#include <collide/bounce.hpp>

namespace collide {

/// Adhesion, as of snow and mud: a particle that touches the mesh no faster than `capture` stays where it is, until
/// forces of more than `strength`, per unit of mass, pull it off. Forces are what changes the velocity of effects that
/// come before it in the list, so it comes after those.
struct stick {
  using writes = columns<position, velocity, stuck>;
  using follows = effects<bounce>;

  double strength = 20;
  double capture = std::numeric_limits<double>::infinity();

  template <class Particle, class S>
  COLLIDE_HD_INLINE void accelerate(Particle& p, S dt) const {
    if (p[stuck{}] == 0) return;
    auto& v = p[velocity{}];
    S const most = S(strength) * dt;
    if (detail::dot(v, v) <= most * most) {
      v = vec3<S>(S(0), S(0), S(0));
    } else {
      p[stuck{}] = 0;
    }
  }
  template <class Particle, class S>
  COLLIDE_HD_INLINE void touch(Particle& p, touching<S>& t, S dt) const {
    auto& v = p[velocity{}];
    S const pressed = detail::smaller(detail::dot(t.gain, t.normal), S(0)), most = S(strength) * dt;
    vec3<S> const pull = t.gain - t.normal * pressed;
    if (!(detail::dot(v, v) <= S(capture) * S(capture) && detail::dot(pull, pull) <= most * most)) return;
    if (t.rests) p[position{}] -= v * t.moved;  // it was held all the time
    v = vec3<S>(S(0), S(0), S(0));
    if (t.depth > 0) p[position{}] += t.normal * t.depth;
    t.depth = detail::smaller(t.depth, S(0));
    p[stuck{}] = 1;
  }
};

}  // namespace collide
