"""Meshes and their queries: arguments, results, errors."""

import copy
import fractions
import gc
import os
import pickle

import numpy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import collide

VERTICES = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], numpy.float32)
TRIANGLES = numpy.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]], numpy.int32)


def random_points(n, dtype=numpy.float32, seed=0):
    return numpy.random.default_rng(seed).uniform(-0.5, 1.5, (n, 3)).astype(dtype)


def laid_out(points, kind):
    """The same points, elsewhere in memory."""
    n = len(points)
    if kind == "fortran":
        return numpy.asfortranarray(points)
    if kind == "rows of four":
        wide = numpy.full((n, 4), numpy.nan, points.dtype)
        wide[:, :3] = points
        return wide[:, :3]
    if kind == "every third":
        many = numpy.full((3 * n, 3), numpy.nan, points.dtype)
        many[::3] = points
        return many[::3]
    if kind == "columns reversed":
        return points[:, ::-1].copy()[:, ::-1]
    if kind == "transposed":
        return points.T.copy().T
    if kind == "read-only":
        points = points.copy()
        points.flags.writeable = False
    return points


LAYOUTS = ["packed", "fortran", "rows of four", "every third", "columns reversed", "transposed", "read-only"]


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.float64])
@pytest.mark.parametrize("kind", LAYOUTS)
def test_layouts_of_all_arguments(kind, dtype):
    centres, moves = random_points(500, dtype), random_points(500, dtype, 1)
    radii = numpy.random.default_rng(2).uniform(0, 0.4, 500).astype(dtype)
    mesh = collide.Mesh(VERTICES.astype(dtype), TRIANGLES)
    other = collide.Mesh(laid_out(VERTICES.astype(dtype), kind), TRIANGLES)
    gaps = numpy.zeros((500, 7), dtype)
    gaps[:, 2] = radii
    here = mesh.impacts(centres, moves, radii, order="canonical")
    there = other.impacts(laid_out(centres, kind), laid_out(moves, kind), gaps[:, 2], order="canonical")
    assert len(here) > 50 and here.records.tobytes() == there.records.tobytes()


@pytest.mark.parametrize("kind", ["fortran", "rows of four", "every third", "read-only"])
@pytest.mark.parametrize("dtype", [numpy.int32, numpy.uint32])
def test_layouts_of_triangles(kind, dtype):
    centres = random_points(300)
    mesh = collide.Mesh(VERTICES, TRIANGLES)
    many = laid_out_integers(TRIANGLES.astype(dtype), kind)
    assert collide.Mesh(VERTICES, many).query(centres, 0.2, order="canonical").records.tobytes() == (
        mesh.query(centres, 0.2, order="canonical").records.tobytes()
    )


def laid_out_integers(triangles, kind):
    if kind == "rows of four":
        return numpy.hstack([triangles, triangles[:, :1] + 99])[:, :3]
    if kind == "every third":
        return numpy.repeat(triangles, 3, axis=0)[::3]
    return laid_out(triangles, kind)


def test_soup_is_the_mesh():
    centres = random_points(300)
    soup = collide.Mesh(numpy.ascontiguousarray(VERTICES[TRIANGLES].reshape(-1, 3)))
    assert len(soup) == 4
    expected = collide.Mesh(VERTICES, TRIANGLES).query(centres, 0.2, order="canonical")
    assert (soup.query(centres, 0.2, order="canonical").records == expected.records).all()


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_outputs_agree(data):
    dtype = data.draw(st.sampled_from([numpy.float32, numpy.float64]))
    n = data.draw(st.integers(0, 200))
    m = data.draw(st.integers(0, 50))
    random = numpy.random.default_rng(data.draw(st.integers(0, 2**32)))
    vertices = random.normal(size=(max(3, m), 3)).astype(dtype)
    triangles = random.integers(0, len(vertices), (m, 3)).astype(data.draw(st.sampled_from([numpy.int32, numpy.uint32])))
    centres = laid_out(random.normal(size=(n, 3)).astype(dtype), data.draw(st.sampled_from(LAYOUTS)))
    radius = random.uniform(-0.1, 0.5, n).astype(dtype) if data.draw(st.booleans()) else 0.3
    precision = data.draw(st.sampled_from(["exact", "double", "single"]))
    moves = random.normal(size=(n, 3)).astype(dtype) if data.draw(st.booleans()) and precision == "exact" else None
    mesh = collide.Mesh(vertices, triangles)
    options = dict(displacements=moves, precision=precision)
    pairs = mesh.query(centres, radius, order="canonical", **options)
    sphere, triangle = pairs
    assert sphere.dtype == triangle.dtype == numpy.int32 and len(sphere) == len(pairs) == pairs.total
    assert mesh.count(centres, radius, **options) == len(pairs)
    flags = mesh.any(centres, radius, **options)
    assert flags.dtype == bool and (numpy.flatnonzero(flags) == numpy.unique(sphere)).all()
    offsets, rows = mesh.query(centres, radius, output="csr", order="canonical", **options)
    assert offsets.dtype == numpy.int64 and (rows == triangle).all()
    assert (numpy.repeat(numpy.arange(n), numpy.diff(offsets)) == sphere).all()
    contacts = mesh.contacts(centres, radius, order="canonical", **options)
    assert (contacts.sphere == sphere).all() and (contacts.triangle == triangle).all()
    assert contacts.point.dtype == contacts.normal.dtype == contacts.distance.dtype == contacts.depth.dtype == dtype
    assert contacts.point.shape == contacts.normal.shape == (len(pairs), 3)
    if moves is None and len(pairs):
        away = numpy.linalg.norm(numpy.asarray(centres)[sphere].astype(float) - contacts.point, axis=1)
        assert numpy.allclose(away, contacts.distance, atol=1e-3) and (contacts.feature <= 2).all()


def test_closest_and_first():
    centres, moves = random_points(300), random_points(300, seed=1)
    mesh = collide.Mesh(VERTICES, TRIANGLES)
    all_contacts, closest = mesh.contacts(centres, 0.3), mesh.contacts(centres, 0.3, closest=True)
    least = numpy.full(300, numpy.inf, numpy.float32)
    numpy.minimum.at(least, all_contacts.sphere, all_contacts.distance)
    assert (closest.distance == least).all() and ((closest.triangle == -1) == numpy.isinf(least)).all()
    impacts, first = mesh.impacts(centres, moves, 0.1), mesh.impacts(centres, moves, 0.1, first=True)
    least = numpy.full(300, numpy.inf, numpy.float32)
    numpy.minimum.at(least, impacts.sphere, impacts.time)
    assert (first.time == least).all() and len(first) == 300


def test_touching_spheres_are_right():
    """4,500 spheres that just touch a face, an edge or a vertex, or by one unit in the last place do not."""
    random = numpy.random.default_rng(5)
    triangle = numpy.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]], numpy.float32)
    mesh = collide.Mesh(triangle, numpy.array([[0, 1, 2]], numpy.int32))
    x = random.uniform(0.1, 1.5, (1500, 3)).astype(numpy.float32)
    above = x.copy()  # distance z
    beside = x * numpy.array([1, -1, 0], numpy.float32)  # distance -y of the edge
    beyond = -x  # distance of the vertex, which is no float in general
    centres = numpy.concatenate([above, beside, beyond])
    squares = [fractions.Fraction(float(p[2])) ** 2 for p in above]
    squares += [fractions.Fraction(float(p[1])) ** 2 for p in beside]
    squares += [sum(fractions.Fraction(float(u)) ** 2 for u in p) for p in beyond]
    nearest = numpy.sqrt(numpy.array([float(s) for s in squares])).astype(numpy.float32)
    for radii in (nearest, numpy.nextafter(nearest, numpy.float32(0)), numpy.nextafter(nearest, numpy.float32(9))):
        expected = [fractions.Fraction(float(r)) ** 2 >= s for r, s in zip(radii, squares)]
        assert (mesh.any(centres, radii) == expected).all()


def test_results_own_their_memory():
    mesh = collide.Mesh(VERTICES, TRIANGLES)
    centres = random_points(1000)
    contacts = mesh.contacts(centres, 0.3, order="canonical")
    point, before = contacts.point, contacts.point.copy()
    del contacts, mesh
    gc.collect()
    for _ in range(20):  # whoever freed it would write over it
        collide.Mesh(VERTICES, TRIANGLES).contacts(random_points(1000, seed=3), 0.3)
    assert (point == before).all()


def test_out_and_capacity():
    mesh, centres = collide.Mesh(VERTICES, TRIANGLES), random_points(1000)
    everything = mesh.query(centres, 0.3, order="canonical")
    n = len(everything)
    room = numpy.full((n + 5, 2), 77, numpy.int32)
    pairs = mesh.query(centres, 0.3, order="canonical", out=room)
    assert len(pairs) == n and pairs.complete and numpy.shares_memory(pairs.records, room)
    assert (room[:n] == everything.records).all() and (room[n:] == 77).all()
    few = mesh.query(centres, 0.3, order="canonical", capacity=7)
    assert len(few) == 7 and few.total == n and not few.complete and (few.records == everything.records[:7]).all()
    none = mesh.contacts(centres, 0.3, capacity=0)
    assert len(none) == 0 and none.total == n
    flags = numpy.zeros(1000, bool)
    assert mesh.any(centres, 0.3, out=flags) is flags and (flags == mesh.any(centres, 0.3)).all()
    records = numpy.zeros((n, 12), numpy.int32)
    contacts = mesh.contacts(centres, 0.3, order="canonical", out=records)
    assert (contacts.point == mesh.contacts(centres, 0.3, order="canonical").point).all()


def test_update():
    vertices, centres = VERTICES.copy(), random_points(500)
    mesh = collide.Mesh(vertices, TRIANGLES)
    mesh.count(centres, 0.1)
    vertices += 0.25
    mesh.update(vertices)
    moved = collide.Mesh(VERTICES + numpy.float32(0.25), TRIANGLES)
    assert mesh.count(centres, 0.1) == moved.count(centres, 0.1)
    with pytest.raises(ValueError, match="vertices: has shape .3, 3., expected .4, 3."):
        mesh.update(vertices[:3])
    with pytest.raises(TypeError, match="vertices: has dtype float64"):
        mesh.update(vertices.astype(float))
    assert mesh.count(centres, 0.1) == moved.count(centres, 0.1)  # as it was
    mesh.update(vertices[:3], TRIANGLES[:1])
    assert len(mesh) == 1


def test_strange_numbers():
    mesh = collide.Mesh(VERTICES, TRIANGLES)
    centres = numpy.array([[0, 0, 0], [numpy.nan, 0, 0], [numpy.inf, 0, 0], [0, 0, 0]], numpy.float32)
    radii = numpy.array([numpy.inf, 1, 1, numpy.nan], numpy.float32)
    assert mesh.any(centres, radii).tolist() == [True, False, False, False]
    assert mesh.count(centres, -1) == 0
    assert mesh.count(centres, numpy.float32(0)) == 3 * 2  # the origin is a corner of three triangles
    assert collide.Mesh(VERTICES, TRIANGLES[:0]).count(centres, 1) == 0
    assert len(mesh.query(centres[:0], 1)) == 0 and mesh.any(centres[:0], 1).shape == (0,)


def test_many_rows_of_one_point():
    """A million spheres that are one number each in memory: stride 0."""
    mesh = collide.Mesh(VERTICES, TRIANGLES)
    centres = numpy.broadcast_to(numpy.float32([0.25, 0.25, 0]), (1_000_000, 3))
    assert mesh.count(centres, 0.01) == 1_000_000


def test_triangles_stay_what_they_were():
    """They are copied, and those of an update are checked, too."""
    triangles, centres = TRIANGLES.copy(), random_points(500)
    mesh = collide.Mesh(VERTICES, triangles)
    expected = mesh.count(centres, 0.1)
    triangles[:] = 2**31 - 1
    mesh.update(VERTICES)
    assert mesh.count(centres, 0.1) == expected and len(mesh.nearest(centres)) == 500
    with pytest.raises(ValueError, match="triangles: 4 triangle.* not a vertex"):
        mesh.update(VERTICES, triangles)
    assert mesh.count(centres, 0.1) == expected
    mesh.update(VERTICES, triangles, validate=False)  # all corners are the last vertex
    assert mesh.count(centres, 0.1) == 4 * collide.Mesh(VERTICES[[3, 3, 3]]).count(centres, 0.1)
    with pytest.raises(ValueError, match="triangles: there are some, and no vertices"):
        collide.Mesh(VERTICES[:0], TRIANGLES, validate=False)


@pytest.mark.parametrize("dtype", [numpy.int64, numpy.uint64, numpy.uint32])
def test_integers_of_triangles(dtype):
    centres, expected = random_points(300), collide.Mesh(VERTICES, TRIANGLES)
    backwards = numpy.ascontiguousarray(TRIANGLES[::-1, ::-1]).astype(dtype)[::-1, ::-1]
    mesh = collide.Mesh(VERTICES, backwards)
    assert (mesh.nearest(centres).records == expected.nearest(centres).records).all()
    for wrong in (-1, 4) if dtype == numpy.uint32 else (-1, 4, 2**32, 2**33 + 1):
        with pytest.raises(ValueError, match="triangles: 1 triangle.* the first is number 2"):
            triangles = TRIANGLES.astype(numpy.int64)
            triangles[2, 1] = wrong
            collide.Mesh(VERTICES, triangles.astype(dtype))


@pytest.mark.parametrize("capacity", [2**31, 2**58, 2**61 + 1, 2**63 - 1])
def test_sizes_do_not_overflow(capacity):
    mesh, centres = collide.Mesh(VERTICES, TRIANGLES), random_points(100)
    try:
        assert len(mesh.contacts(centres, 0.3, capacity=capacity)) == mesh.count(centres, 0.3)
    except MemoryError:
        assert capacity >= 2**31


def test_too_many_rows():
    mesh = collide.Mesh(VERTICES, TRIANGLES)
    many = numpy.broadcast_to(VERTICES[:1], (2**31, 3))
    for call in (lambda: mesh.any(many, 1), lambda: mesh.nearest(many), lambda: collide.Mesh(many, TRIANGLES), lambda: mesh.update(many)):
        with pytest.raises(ValueError, match="has more than 2,147,483,647 rows|has shape"):
            call()
    with pytest.raises(ValueError, match="triangles: has more than 2,147,483,647 rows"):
        collide.Mesh(VERTICES, numpy.broadcast_to(TRIANGLES[:1], (2**40, 3)))


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_copies(copied):
    centres = random_points(100)
    for triangles in (TRIANGLES, None):
        mesh = collide.Mesh(VERTICES.copy() if triangles is not None else VERTICES[TRIANGLES].reshape(-1, 3), triangles)
        other = copied(mesh)
        assert len(other) == 4 and (other.signed_distance(centres).records == mesh.signed_distance(centres).records).all()
        if copied is not copy.copy:
            mesh.update(VERTICES + 9 if triangles is not None else (VERTICES + 9)[TRIANGLES].reshape(-1, 3))
            assert other.count(centres, 0.3) > 0 == mesh.count(centres, 0.3)
    pairs, contacts = mesh.query(centres - 9, 1), other.contacts(centres, 1)
    for found, name in ((pairs, "triangle"), (contacts, "point"), (other.nearest(centres), "distance")):
        again = copied(found)
        assert type(again) is type(found) and (getattr(again, name) == getattr(found, name)).all() and len(again) == len(found)
    rows = other.query(centres, 1, output="csr")
    assert all((a == b).all() for a, b in zip(rows, copied(rows)))


class OfOpen3d:
    """Its kinds of devices are no integers."""

    class Kind:
        value = 1

    def __init__(self, array):
        self.array = array

    def __dlpack_device__(self):
        return self.Kind(), 0

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)


def test_devices_that_are_no_numbers():
    mesh = collide.Mesh(OfOpen3d(VERTICES.copy()), OfOpen3d(TRIANGLES.copy()))
    assert mesh.count(OfOpen3d(VERTICES.copy()), 0) == 12


class NoArray:
    pass


class Liar:
    """Says that it is an array."""

    def __dlpack_device__(self):
        return "the host"

    def __dlpack__(self, **options):
        return 5

    def __repr__(self):
        raise RuntimeError


UNALIGNED = numpy.frombuffer(bytes(61), numpy.uint8)[1:].view(numpy.float32).reshape(5, 3)


BAD = [
    (dict(centres={}), TypeError, "centres: expected an array"),
    (dict(centres=None), TypeError, "centres: expected an array"),
    (dict(centres=NoArray()), TypeError, "centres: expected an array"),
    (dict(centres=Liar()), TypeError, "centres: "),
    (dict(radius=Liar()), TypeError, "radius: "),
    (dict(centres=numpy.ndarray), TypeError, "centres: "),
    (dict(centres=UNALIGNED), ValueError, "centres: lies at an address that is no multiple"),
    (dict(radius=10**400), ValueError, "radius: int too large"),
    (dict(capacity=-1), ValueError, "capacity: is -1, expected 0 to"),
    (dict(capacity=2**64), ValueError, "capacity: is 18446744073709551616, expected 0 to"),
    (dict(capacity=1.5), TypeError, "capacity: expected a whole number, got 1.5"),
    (dict(capacity=Liar()), TypeError, "capacity: expected a whole number, got .?"),
    (dict(precision=5), ValueError, "precision: is 5"),
    (dict(order=numpy.zeros(2)), ValueError, "order: is array"),
    (dict(output=None), ValueError, "output: is None, expected 'pairs' or 'csr'"),
    (dict(centres=numpy.zeros((5, 3))), TypeError, "centres: has dtype float64, expected float32"),
    (dict(centres=numpy.zeros((5, 3), ">f4")), TypeError, "centres: "),
    (dict(centres=numpy.zeros((5, 3), int)), TypeError, "centres: has dtype int64"),
    (dict(centres=numpy.zeros((5, 2), numpy.float32)), ValueError, r"centres: has shape \(5, 2\), expected \(n, 3\)"),
    (dict(centres=numpy.zeros(3, numpy.float32)), ValueError, r"centres: has shape \(3,\)"),
    (dict(centres=numpy.zeros((5, 3), numpy.float32)[::-1]), ValueError, "centres: has rows in reverse order"),
    (dict(radius="1"), TypeError, "radius: expected an array"),
    (dict(radius=None), TypeError, "radius: expected an array"),
    (dict(radius=numpy.zeros(4, numpy.float32)), ValueError, r"radius: has shape \(4,\), expected a number or \(5,\)"),
    (dict(radius=numpy.zeros(5)), TypeError, "radius: has dtype float64"),
    (dict(radius=numpy.zeros(5, numpy.float32)[::-1]), ValueError, "radius: has rows in reverse"),
    (dict(precision="exactly"), ValueError, "precision: is 'exactly'"),
    (dict(order="sorted"), ValueError, "order: is 'sorted'"),
    (dict(output="list"), ValueError, "output: is 'list'"),
    (dict(output="csr", capacity=1), ValueError, "capacity: "),
    (dict(displacements=numpy.zeros((4, 3), numpy.float32)), ValueError, "displacements: has 4 rows, expected 5"),
    (dict(displacements=numpy.zeros((5, 3))), TypeError, "displacements: has dtype float64"),
    (dict(displacements=numpy.zeros((5, 3), numpy.float32), precision="single"), ValueError, "precision: "),
    (dict(out=numpy.zeros((5, 2))), TypeError, "out: has dtype float64, expected int32"),
    (dict(out=numpy.zeros((5, 3), numpy.int32)), ValueError, r"out: has shape .5, 3., expected .capacity, 2."),
    (dict(out=numpy.zeros((5, 4), numpy.int32)[:, ::2]), ValueError, "out: is not packed"),
]


@pytest.mark.parametrize("arguments, error, text", BAD)
def test_bad_arguments_are_named(arguments, error, text):
    mesh = collide.Mesh(VERTICES, TRIANGLES)
    with pytest.raises(error, match=text):
        mesh.query(**{"centres": numpy.zeros((5, 3), numpy.float32), "radius": 1.0, **arguments})
    assert mesh.count(VERTICES, 0) == 12  # as if nothing had been


def test_read_only_out():
    out = numpy.zeros((5, 2), numpy.int32)
    out.flags.writeable = False
    with pytest.raises(TypeError, match="out: "):
        collide.Mesh(VERTICES, TRIANGLES).query(VERTICES, 1, out=out)


@pytest.mark.parametrize(
    "vertices, triangles, error, text",
    [
        (VERTICES.astype(numpy.float16), TRIANGLES, TypeError, "vertices: has dtype float16"),
        (VERTICES, TRIANGLES.astype(numpy.int16), TypeError, "triangles: has dtype int16, expected integers of 32 or 64 bits"),
        (VERTICES, TRIANGLES.astype(numpy.int64) + 2**32, ValueError, "triangles: 4 triangle.* not a vertex"),
        (VERTICES, TRIANGLES.astype(float), TypeError, "triangles: has dtype float64"),
        (VERTICES, TRIANGLES[:, :2], ValueError, r"triangles: has shape \(4, 2\)"),
        (VERTICES, TRIANGLES + 1, ValueError, "triangles: 3 triangle.* not a vertex"),
        (VERTICES, TRIANGLES - 1, ValueError, "triangles: 3 triangle.* not a vertex"),
        (VERTICES, None, ValueError, "vertices: .* without triangles"),
        ("mesh.stl", TRIANGLES, TypeError, "vertices: expected an array"),
    ],
)
def test_bad_meshes_are_named(vertices, triangles, error, text):
    with pytest.raises(error, match=text):
        collide.Mesh(vertices, triangles)


@pytest.mark.parametrize("call, error, text", [
    (lambda m, x: m.nearest(x, max_distance=None), TypeError, "max_distance: expected a number, got None"),
    (lambda m, x: m.nearest(x, max_distance="1"), TypeError, "max_distance: expected a number, got '1'"),
    (lambda m, x: m.nearest(x, max_distance=numpy.nan), ValueError, "max_distance: is negative or NaN"),
    (lambda m, x: m.k_nearest(x, 1.5), TypeError, "k: expected a whole number, got 1.5"),
    (lambda m, x: m.k_nearest(x, 2**40), ValueError, "k: is 1099511627776, expected 1 to 32"),
    (lambda m, x: collide.Mesh(x, threads=-1), ValueError, "threads: is -1"),
    (lambda m, x: collide.Mesh(x, threads=None), TypeError, "threads: expected a whole number"),
])
def test_bad_numbers_are_named(call, error, text):
    with pytest.raises(error, match=text):
        call(collide.Mesh(VERTICES, TRIANGLES), random_points(5))


def test_no_more_threads_than_cores():
    mesh = collide.Mesh(VERTICES, TRIANGLES, threads=10**5)
    assert mesh.count(numpy.repeat(VERTICES, 10**4, axis=0), 0) == 12 * 10**4
    assert len(os.listdir("/proc/self/task")) < 200


def test_help():
    for thing in (collide, collide.Mesh, collide.Mesh.query, collide.Mesh.nearest, collide.Nearest.point, collide.Simulation,
                  collide.Pairs, collide.gravity):
        assert len(thing.__doc__) > 40
