"""drum_stl.py FILE: a closed drum with four lifters as STL, in millimetres: radius 100, from y = -30 to 30."""
import math
import sys


def ring(radius, sides):
    return [(radius * math.cos(2 * math.pi * k / sides), radius * math.sin(2 * math.pi * k / sides)) for k in range(sides + 1)]


def wall(path):
    for (a, c), (b, d) in zip(path, path[1:]):
        yield from (((a, -30, c), (b, -30, d), (b, 30, d)), ((a, -30, c), (b, 30, d), (a, 30, c)))


triangles = list(wall(ring(100, 32)))
for y in (-30, 30):
    triangles += [((0, y, 0), (a, y, c), (b, y, d)) for (a, c), (b, d) in zip(ring(100, 32), ring(100, 32)[1:])]
for (x, z), (a, c) in zip(ring(100, 4)[:4], ring(85, 4)[:4]):  # plates from the wall inwards
    triangles += wall([(x, z), (a, c)])
with open(sys.argv[1], "w") as file:
    print("solid drum", file=file)
    for corners in triangles:
        print("facet normal 0 0 0\nouter loop", file=file)
        for corner in corners:
            print("vertex %.9g %.9g %.9g" % corner, file=file)
        print("endloop\nendfacet", file=file)
    print("endsolid drum", file=file)
