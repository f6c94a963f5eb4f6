"""Draws the signed distance to a mesh on a plane through its middle. distance_map.py [FILE OF A MESH] [PICTURE]

The file is one that trimesh reads, of a closed mesh; without one it is a torus. It needs matplotlib for the
picture, distance_map.png, and without it prints the distances that it would draw.
"""

import sys
import types

import numpy

import collide


def torus(n=64):
    """A torus around the z axis, of radii 1 and 0.4."""
    u, v = numpy.meshgrid(*[numpy.arange(n)] * 2, indexing="ij")
    a, b = 2 * numpy.pi * u.ravel() / n, 2 * numpy.pi * v.ravel() / n
    ring = 1 + 0.4 * numpy.cos(b)
    corner = [((u + i) % n * n + (v + j) % n).ravel() for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    faces = [numpy.stack([corner[k] for k in t], 1) for t in ((0, 1, 2), (0, 2, 3))]
    vertices = numpy.stack([ring * numpy.cos(a), ring * numpy.sin(a), 0.4 * numpy.sin(b)], 1)
    return types.SimpleNamespace(vertices=vertices, faces=numpy.concatenate(faces))


def read(path):
    import trimesh

    return trimesh.load(path, force="mesh")


drawn = read(sys.argv[1]) if len(sys.argv) > 1 else torus()
vertices, mesh = numpy.asarray(drawn.vertices), collide.Mesh.of(drawn)
lower, upper = numpy.min(vertices, axis=0), numpy.max(vertices, axis=0)
middle, reach = (lower + upper) / 2, 0.6 * (upper - lower).max()
side = numpy.linspace(-reach, reach, 400)
x, y = numpy.meshgrid(middle[0] + side, middle[1] + side)
points = numpy.stack([x, y, numpy.full_like(x, middle[2])], -1).reshape(-1, 3)
distance = mesh.distance(points, signed=True).reshape(x.shape)
print(f"{len(mesh)} triangles, {distance.size} points: from {distance.min():.3f} to {distance.max():.3f}")
try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plot
except ImportError:
    sys.exit()
plot.figure(figsize=(6, 6))
plot.contourf(x, y, distance, 40, cmap="RdBu")
plot.contour(x, y, distance, [0], colors="black")
plot.axis("equal")
plot.savefig(sys.argv[2] if len(sys.argv) > 2 else "distance_map.png", dpi=100)
