"""Grains that fall onto a plate and form a heap: examples/granular.cpp in Python."""

import numpy

import collide
from collide import granular

try:
    from tqdm import tqdm  # shows progress, where it is installed
except ImportError:
    tqdm = None

vertices = numpy.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
plate = collide.Mesh(vertices, numpy.array([[0, 1, 2], [0, 2, 3]], numpy.int32))
materials = granular.materials(granular.Solid(1e7, 0.2, 2500), granular.SurfacePair(0.5, 0.5, 0.1))
contact = collide.granular_contact(granular.hertz(), granular.mindlin(), granular.epsd(), materials=materials)
grains = collide.Simulation(plate, [collide.gravity(), contact, collide.velocity_verlet()])

k, radius = numpy.arange(160), 0.005  # a column, 4 by 4 grains wide
shift = 1e-4 * (k % 7)
x, y, z = (k % 4 - 1.5) * 0.0101 + shift, (k // 4 % 4 - 1.5) * 0.0101 - shift, 0.006 + k // 16 * 0.0101
grains.set(numpy.stack([x, y, z], axis=1), radius)
dt = grains.largest_time_step()
steps = int(1 / dt)
bar = tqdm(total=steps, unit="step") if tqdm else None
grains.steps(steps, dt, call=bar and (lambda done: bar.update(done - bar.n)))
print(f"after {grains.time:.2f} s the heap is {100 * (grains['position'][:, 2].max() + radius):.1f} cm high")
