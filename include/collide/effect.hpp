/// \file
/// What an effect is: what happens to a particle in a step of a simulation.
///
/// An effect is a small copyable struct with its parameters. It names the columns that it works on,
///
///     using reads = columns<...>;    // optional: columns that it looks at
///     using writes = columns<...>;   // optional: columns that it changes (and may look at)
///     using shares = columns<...>;   // optional: columns that it changes only if another effect of the scene has them
///     using follows = effects<...>;  // optional: effects that must come before it in the scene's list, if they do
///
/// and has one or more of these members, each `COLLIDE_HD`, const, and a template over the type of the particle:
///
/// | member                            | called |
/// |-----------------------------------|-------------------------------------------------------------------------------|
/// | `skips(particle)`                 | first: true if nothing happens to the particle in this step | |
/// `accelerate(particle&, dt)`       | before positions move: change the velocity                                    |
/// | `touch(particle&, touching&, dt)` | for each contact with the mesh, the deepest (swept: the earliest) first | |
/// `meet(particle&, self, other, dt)`| for each other particle that overlaps it; only then are neighbours listed     |
/// | `disturb(particle&, other)`       | instead, if the particle is skipped and the other is not | |
/// `finish(particle&, dt)`           | at the end of the step                                                        |
///
/// and on the host `begin_step(space, state, dt)`, which may launch work on the space and must not wait. `meet` is
/// called before the other members but `begin_step`: `self` and `other` are as they were when the step began, and what
/// changes is `particle`, so that both of a pair see the same.
///
/// A particle is a value in registers: `p[velocity{}]` is a reference to its velocity, `p.radius()` and `p.number()`
/// are its radius and its number, and `Particle::template has<C>` tells whether the scene has the column C. Members are
/// called in the order of the scene's list. What a scene does not name costs nothing: neither memory nor instructions.
#pragma once

#include <collide/columns.hpp>
#include <collide/contact.hpp>

namespace collide {

/// A list of effects.
template <class... Effect>
struct effects {};

/// A particle's contact with the mesh, as `touch` gets it. `depth` is how deep the triangle still is in the sphere,
/// where the particle is now: an effect that pushes the particle out takes off what it pushed.
template <class S>
struct touching : contact<S> {
  vec3<S> gain;  ///< what a step's acceleration adds to the velocity
  S moved;       ///< for how long the particle has moved before it was stopped: the step, or 0 if its way is swept
  S impulse;     ///< what the effects have added to the velocity along the normal: 0, or what repels
  bool rests;    ///< an effect has found that the particle rests on the surface, or slides on it
};

}  // namespace collide
