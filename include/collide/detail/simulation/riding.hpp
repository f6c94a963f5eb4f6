/// \file
/// Particles that stick to a body, and move with it.
#pragma once

#include <collide/detail/simulation/moving_mesh.hpp>
#include <collide/detail/simulation/step_context.hpp>

namespace collide::detail {

/// The frame of the body that a particle sticks to; 0 if it is free, or sticks to what rests. See `adhesion`.
template <class Particle>
COLLIDE_HD_INLINE int frame_ridden(Particle const& p) {
  int const held = p[adhered{}];
  return held > 1 ? held - 1 : 0;
}

/// Where a body takes a point of space in the step that it has at the beginning.
template <class S>
COLLIDE_HD_INLINE vec3<double> carried(body_frame<S> const& f, vec3<double> const& x) {
  return f.now.to_world(f.before.to_local(x));
}

/// Lets the effects accelerate a particle that sticks to a body: by what pulls at it as seen from there, so that
/// `adhesion` holds it or not. What it holds moves with the body; its place is still that at the step's beginning.
template <class Context, class Particle, class S>
COLLIDE_HD_INLINE void accelerate_on_body(Context const& context, Particle& p, int frame, S time) {
  body_frame<S> const& f = context.triangles.mesh.frames[frame];
  vec3<double> const x = p[position{}].template cast<double>(), to = carried(f, x);
  vec3<double> const before = velocity_at(f.moved, f.before, x), after = velocity_at(f.moving, f.now, to);
  double const part = context.dt != 0 ? div(static_cast<double>(time), static_cast<double>(context.dt)) : 0;
  vec3<double> own = scaled(vec3<double>(before - after), part);
  p[velocity{}] = rounded_to<S>(own);
  context.effects.accelerate(p, time);
  own = p[velocity{}].template cast<double>();
  vec3<double> drift = after;
  if constexpr (Context::is_swept) {  // straight to where the body takes it
    double const dt = static_cast<double>(context.dt);
    if (dt != 0) drift = vec3<double>(div(to.x() - x.x(), dt), div(to.y() - x.y(), dt), div(to.z() - x.z(), dt));
  }
  p[velocity{}] = rounded_to<S>(own + drift);
}

}  // namespace collide::detail
