"""A paddle that a servo turns: its rate changes, and its angle does not jump."""

import numpy

import collide

vertices = numpy.array([[0, 0, -1], [1, 0, -1], [1, 0, 1], [0, 0, 1]], float)  # in the plane y = 0
paddle = collide.Mesh(vertices, numpy.array([[0, 1, 2], [0, 2, 3]]))
effects = [collide.driven_bodies(), collide.bounce(0)]
sim = collide.Simulation(paddle, effects, bodies=[collide.Body(0, 2, axis=(0, 0, 1))])
sim.set(numpy.array([[0.5, 0.11, 0]]), 0.1)

dt, angle, rate, wanted = 1e-4, 0.0, 0.0, 0.5
for _ in range(4000):
    rate += min(max(wanted - rate, -0.01), 0.01)  # what the motor can do in a step
    angle += rate * dt
    sim.drive(0, angle, rate)
    sim.step(dt)
speed = numpy.linalg.norm(sim["velocity"][0])
print(f"the paddle has turned by {angle:.2f} rad, and pushes the ball at {speed:.2f} m/s")
