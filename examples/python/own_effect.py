"""An effect of one's own: a spring to the origin, which a compiler makes part of the simulation."""

import math

import numpy

import collide

SPRING = """
struct spring {
  using reads = collide::columns<collide::position>;
  using writes = collide::columns<collide::velocity>;

  double stiffness = 1;  // acceleration at a distance of 1

  template <class Particle, class S>
  COLLIDE_HD void accelerate(Particle& p, S dt) const {
    p[collide::velocity{}] -= p[collide::position{}] * (S(stiffness) * dt);
  }
};
"""
spring = collide.Effect("spring", {"stiffness": 4.0}, code=SPRING)

nothing = collide.Mesh(numpy.zeros((0, 3), numpy.float32))
sim = collide.Simulation(nothing, [spring])
sim.set(numpy.array([[1, 0, 0]], numpy.float32), 0.1)
sim.steps(1000, math.pi / 1000)  # a period
print(f"after a period it is at {sim['position'][0, 0]:.3f}")
