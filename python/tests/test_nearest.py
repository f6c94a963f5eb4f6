"""Nearest triangles, inside and signed distance: against brute force in rational numbers and in double, and against C++."""

import fractions

import numpy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import collide
from test_mesh import LAYOUTS, TRIANGLES, VERTICES, laid_out, random_points

CUBE = numpy.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], numpy.float32)
FACES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
FACES = numpy.array(FACES, numpy.int32)


def nearest_of_triangle(p, a, b, c):
    """The nearest point of a triangle by the regions of its plane: C. Ericson, Real-Time Collision Detection, 5.1.5, with
    numbers of any kind."""
    dot = lambda u, v: u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    minus = lambda u, v: [u[k] - v[k] for k in range(3)]
    along = lambda u, v, t: [u[k] + t * v[k] for k in range(3)]
    ab, ac, ap = minus(b, a), minus(c, a), minus(p, a)
    d1, d2 = dot(ab, ap), dot(ac, ap)
    if d1 <= 0 and d2 <= 0:
        return a
    bp = minus(p, b)
    d3, d4 = dot(ab, bp), dot(ac, bp)
    if d3 >= 0 and d4 <= d3:
        return b
    if d1 * d4 - d3 * d2 <= 0 and d1 >= 0 and d3 <= 0:
        return along(a, ab, d1 / (d1 - d3))
    cp = minus(p, c)
    d5, d6 = dot(ab, cp), dot(ac, cp)
    if d6 >= 0 and d5 <= d6:
        return c
    if d5 * d2 - d1 * d6 <= 0 and d2 >= 0 and d6 <= 0:
        return along(a, ac, d2 / (d2 - d6))
    if d3 * d6 - d5 * d4 <= 0 and d4 - d3 >= 0 and d5 - d6 >= 0:
        return along(b, minus(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6)))
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    return along(along(a, ab, vb / (va + vb + vc)), ac, vc / (va + vb + vc))


def squared_distances(point, corners):
    """To each triangle, exactly."""
    p = [fractions.Fraction(float(u)) for u in point]
    found = []
    for triangle in corners:
        a, b, c = ([fractions.Fraction(float(u)) for u in corner] for corner in triangle)
        q = nearest_of_triangle(p, a, b, c)
        found.append(sum((q[k] - p[k]) ** 2 for k in range(3)))
    return found


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.float64])
@pytest.mark.parametrize("name", ["random", "lattice"])
def test_nearest_is_that_of_rational_numbers(name, dtype):
    random = numpy.random.default_rng(3)
    whole = name == "lattice"  # many triangles are equally near
    draw = lambda shape: (random.integers(-3, 4, shape) if whole else random.normal(size=shape)).astype(dtype)
    corners, points = draw((25, 3, 3)), draw((60, 3))
    normal = numpy.cross((corners[:, 1] - corners[:, 0]).astype(float), (corners[:, 2] - corners[:, 0]).astype(float))
    corners = corners[numpy.linalg.norm(normal, axis=1) > 1e-3]  # the rule above is for triangles with an area
    mesh = collide.Mesh(corners.reshape(-1, 3).copy())
    near, many = mesh.nearest(points), mesh.k_nearest(points, 4)
    for i, point in enumerate(points):
        exact = squared_distances(point, corners)
        order = sorted(range(len(exact)), key=lambda t: (exact[t], t))
        assert near.triangle[i] == order[0] and many.triangle[i].tolist() == order[:4]
        assert numpy.allclose(many.distance[i], [float(exact[t]) ** 0.5 for t in order[:4]], rtol=1e-6)
        within = mesh.nearest(points[i : i + 1], max_distance=float(near.distance[i]) * 0.999)
        assert within.triangle[0] == -1 and within.distance[0] == numpy.inf or near.distance[i] == 0


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_outputs_agree(data):
    dtype = data.draw(st.sampled_from([numpy.float32, numpy.float64]))
    n, m, k = data.draw(st.integers(0, 60)), data.draw(st.integers(0, 30)), data.draw(st.integers(1, 32))
    random = numpy.random.default_rng(data.draw(st.integers(0, 2**32)))
    vertices = random.normal(size=(max(3, m), 3)).astype(dtype)
    triangles = random.integers(0, len(vertices), (m, 3)).astype(data.draw(st.sampled_from([numpy.int32, numpy.uint32])))
    points = random.normal(size=(n, 3)).astype(dtype)
    reach = data.draw(st.sampled_from([numpy.inf, 0.5, 0]))
    mesh = collide.Mesh(vertices, triangles)
    laid = laid_out(points, data.draw(st.sampled_from(LAYOUTS)))
    options = dict(max_distance=reach)
    near, many, side = mesh.nearest(laid, **options), mesh.k_nearest(laid, k, **options), mesh.signed_distance(laid, **options)
    assert len(near) == len(many) == len(side) == n and many.triangle.shape == many.distance.shape == (n, k)
    assert near.triangle.dtype == near.feature.dtype == numpy.int32 and near.point.dtype == near.distance.dtype == dtype
    assert near.point.shape == side.gradient.shape == (n, 3) and many.barycentric.shape == (n, k, 3)
    for name in ("triangle", "distance", "point", "barycentric", "feature", "feature_index"):
        here, there, first = getattr(near, name), getattr(side, name), getattr(many, name)[:, 0]
        assert numpy.array_equal(here, numpy.abs(there) if name == "distance" else there, equal_nan=True) or name == "distance"
        assert numpy.array_equal(here, first, equal_nan=True)
    found = near.triangle >= 0
    assert (found == numpy.isfinite(near.distance)).all() and (found == numpy.isfinite(near.point).all(axis=1)).all()
    assert (numpy.diff(many.distance[numpy.isfinite(many.distance).all(axis=1)], axis=1) >= 0).all()
    inside = mesh.contains(laid)
    assert inside.dtype == bool and inside.shape == (n,)
    assert ((side.distance <= 0) >= inside).all() and ((side.distance < 0) <= inside).all()
    corners = vertices[triangles[near.triangle[found]].astype(int)].astype(float)
    weighted = (near.barycentric[found][:, :, None] * corners).sum(axis=1)
    assert numpy.allclose(weighted, near.point[found], atol=1e-5)
    away = numpy.linalg.norm(points[found].astype(float) - near.point[found], axis=1)
    assert numpy.allclose(away, near.distance[found], atol=1e-5)


def test_cube():
    mesh = collide.Mesh(CUBE, FACES)
    axis = numpy.linspace(-0.5, 1.5, 17, dtype=numpy.float32)  # on faces, edges and corners, too
    points = numpy.stack(numpy.meshgrid(axis, axis, axis), -1).reshape(-1, 3)
    inner = (numpy.abs(points - 0.5) <= 0.5).all(axis=1)
    on = inner & (numpy.abs(points - 0.5) == 0.5).any(axis=1)
    outside = numpy.linalg.norm(numpy.maximum(numpy.abs(points - 0.5) - 0.5, 0), axis=1)
    distance = numpy.where(inner, -(0.5 - numpy.abs(points - 0.5)).min(axis=1), outside)
    found = mesh.signed_distance(points)
    assert (mesh.contains(points) == inner).all() and numpy.allclose(found.distance, distance, atol=1e-6)
    assert ((found.distance == 0) == on).all() and numpy.allclose(numpy.linalg.norm(found.gradient, axis=1), 1, atol=1e-6)
    far = mesh.signed_distance(numpy.float32([[0.5, 0.5, 0.5], [3, 0, 0], [numpy.nan, 0, 0]]), max_distance=0.25)
    assert far.distance.tolist() == [-numpy.inf, numpy.inf, numpy.inf] and (far.triangle == -1).all()
    assert numpy.isnan(far.gradient).all() and not mesh.contains(numpy.float32([[numpy.inf, 0.5, 0.5]])).any()
    mesh.update(CUBE + numpy.float32(1))
    assert mesh.contains(numpy.float32([[0.5, 0.5, 0.5], [1.5, 1.5, 1.5]])).tolist() == [False, True]


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.float64])
def test_out(dtype):
    mesh, points = collide.Mesh(CUBE.astype(dtype), FACES), random_points(300, dtype)
    wide = dtype == numpy.float64
    rooms = {"nearest": (300, 18 if wide else 10), "signed_distance": (300, 24 if wide else 13), "k_nearest": (300, 3, 18 if wide else 10)}
    for name, shape in rooms.items():
        more = (3,) if name == "k_nearest" else ()
        room = numpy.full(shape, 77, numpy.int32)
        own, given_room = getattr(mesh, name)(points, *more), getattr(mesh, name)(points, *more, out=room)
        assert given_room.records is room
        for field in ("triangle", "distance", "point") + (("gradient",) if name == "signed_distance" else ()):
            assert numpy.array_equal(getattr(own, field), getattr(given_room, field))
    flags = numpy.zeros(300, bool)
    assert mesh.contains(points, out=flags) is flags and (flags == mesh.contains(points)).all() and flags.any()


BAD = [
    (lambda m, p: m.nearest({}), TypeError, "points: expected an array"),
    (lambda m, p: m.nearest(p.astype(float)), TypeError, "points: has dtype float64, expected float32"),
    (lambda m, p: m.contains(p[:, :2]), ValueError, r"points: has shape \(5, 2\), expected \(n, 3\)"),
    (lambda m, p: m.signed_distance(p[::-1]), ValueError, "points: has rows in reverse order"),
    (lambda m, p: m.nearest(p, max_distance=-1), ValueError, "max_distance: is negative or NaN"),
    (lambda m, p: m.nearest(p, max_distance=numpy.nan), ValueError, "max_distance: is negative or NaN"),
    (lambda m, p: m.k_nearest(p, 33), ValueError, "k: is 33, expected 1 to 32"),
    (lambda m, p: m.k_nearest(p, 0), ValueError, "k: is 0, expected 1 to 32"),
    (lambda m, p: m.nearest(p, out=numpy.zeros((5, 9), numpy.int32)), ValueError, r"out: has shape \(5, 9\), expected \(5, 10\)"),
    (lambda m, p: m.k_nearest(p, 2, out=numpy.zeros((5, 10), numpy.int32)), ValueError, r"out: .* expected \(5, 2, 10\)"),
    (lambda m, p: m.k_nearest(p, 2, out=numpy.zeros((2, 5, 10), numpy.int32).swapaxes(0, 1)), ValueError, "out: is not packed"),
    (lambda m, p: m.contains(p, out=numpy.zeros(4, bool)), ValueError, r"out: has shape \(4,\), expected \(5,\)"),
    (lambda m, p: m.contains(p, out=numpy.zeros(5)), TypeError, "out: has dtype float64, expected uint8"),
]


@pytest.mark.parametrize("call, error, text", BAD)
def test_bad_arguments_are_named(call, error, text):
    mesh, points = collide.Mesh(VERTICES, TRIANGLES), VERTICES[[0, 1, 2, 3, 0]].copy()
    with pytest.raises(error, match=text):
        call(mesh, points)
    assert mesh.nearest(VERTICES).distance.tolist() == [0, 0, 0, 0]  # as if nothing had been
