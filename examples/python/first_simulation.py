import numpy

import collide

vertices = numpy.array([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], numpy.float32)
floor = collide.Mesh(vertices, numpy.array([[0, 1, 2], [0, 2, 3]], numpy.int32))
sim = collide.Simulation(floor, [collide.gravity(0, 0, -9.81), collide.bounce(0.5)])
sim.set(numpy.array([[0, 0, 2], [1, 0, 3]], numpy.float32), 0.25)
sim.steps(5000, 1e-3)
x = sim["position"]
print(f"after {sim.time:.0f} s the centres are {x[0, 2]:.2f} and {x[1, 2]:.2f} m high")
