import numpy

import collide

vertices = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], numpy.float32)
centres = numpy.array([[0.2, 0.2, 0.4], [2, 2, 2]], numpy.float32)
mesh = collide.Mesh(vertices, numpy.array([[0, 1, 2]], numpy.int32))
for sphere, triangle in zip(*mesh.query(centres, 0.5)):
    print(f"sphere {sphere} touches triangle {triangle}")
