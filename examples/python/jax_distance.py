"""A signed distance in JAX that can be compiled and has gradients: the query is a call to the host, its gradient the library's."""

import jax
import numpy

import collide

vertices = numpy.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], numpy.float32)
quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
mesh = collide.Mesh(vertices, numpy.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]))


def measured(points):
    """Distances and their gradients, as arrays of numpy."""
    found = mesh.signed_distance(numpy.asarray(points))
    return numpy.array(found.distance), numpy.array(found.gradient)


def both(points):
    shapes = jax.ShapeDtypeStruct(points.shape[:1], points.dtype), jax.ShapeDtypeStruct(points.shape, points.dtype)
    return jax.pure_callback(measured, shapes, points)


@jax.custom_vjp
def signed_distance(points):
    return both(points)[0]


signed_distance.defvjp(both, lambda gradient, of_distance: (of_distance[:, None] * gradient,))

points = jax.numpy.array([[2, 0.5, 0.5], [0.5, 0.5, 0.9]], "float32")
print(jax.jit(signed_distance)(points), jax.jit(jax.grad(lambda p: signed_distance(p).sum()))(points).tolist())
