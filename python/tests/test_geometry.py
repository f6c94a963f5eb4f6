"""Is a mesh closed, and where does it cut itself; distances alone, winding numbers, poses, meshes of other libraries."""

import types
import warnings

import numpy
import pytest

import collide

CUBE = numpy.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = numpy.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))], numpy.int64)
FLOATS = pytest.mark.parametrize("dtype", [numpy.float32, numpy.float64])


def cube(dtype=numpy.float64, at=(0, 0, 0), faces=FACES, **options):
    return collide.Mesh((CUBE + at).astype(dtype), faces, **options)


def random_points(n, dtype=numpy.float64, seed=0):
    return numpy.random.default_rng(seed).uniform(-0.5, 1.5, (n, 3)).astype(dtype)


@FLOATS
def test_what_is_closed(dtype):
    mesh = cube(dtype)
    seams = mesh.validate_closed()
    assert mesh.is_closed and seams.is_oriented and seams.message == "" and seams.open_edges.shape == (0, 2)
    seams = cube(dtype, faces=FACES[1:]).validate_closed()
    assert not seams.is_closed and sorted(seams.open_edges[:, 0]) == [0, 4, 10] and "3 open edge(s)" in seams.message
    flipped = numpy.concatenate([FACES[:1, ::-1], FACES[1:]])
    assert not cube(dtype, faces=flipped).validate_closed().is_oriented
    twice = cube(dtype, faces=numpy.concatenate([FACES, FACES[:1]])).validate_closed()
    assert twice.duplicate_faces.tolist() == [[12, 0]] and len(twice.crowded_edges) == 9


@FLOATS
def test_the_quick_look_finds_what_validate_closed_finds(dtype):
    """Of meshes that lack triangles, have some twice, as soups, with vertices apart, NaN, and triangles without area."""
    random, answers = numpy.random.default_rng(1), set()
    for _ in range(300):
        faces = FACES[numpy.flatnonzero(random.random(12) < random.choice([0.5, 0.95, 1]))]
        faces = numpy.concatenate([faces, FACES[random.integers(0, 12, random.choice([0, 0, 1, 2]))]] * random.choice([1, 2]))
        vertices = CUBE.copy()
        if random.random() < 0.2:
            vertices[random.integers(8)] = random.choice([0.0, -0.0, numpy.nan, 1e-300])
        if random.random() < 0.3:
            vertices, faces = vertices[faces.reshape(-1)], None
        mesh = collide.Mesh(vertices.astype(dtype), faces)
        quick, slow = mesh._mesh.seems_closed((0, -1)), mesh.is_closed
        assert quick == slow
        answers.add(slow)
    assert answers == {False, True}


def test_a_mesh_with_holes_warns_once():
    mesh, points = cube(faces=FACES[1:]), random_points(5)
    with pytest.warns(UserWarning, match=r"not closed.*validate_closed\(\).*winding_number") as caught:
        mesh.contains(points)
    assert len(caught) == 1 and caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh.signed_distance(points)
        mesh.update(CUBE)
        mesh.distance(points, signed=True)
        cube().contains(points)
        cube(faces=FACES[1:]).nearest(points)
    with pytest.warns(UserWarning, match="not closed"):
        mesh.update(CUBE, FACES[2:])
        mesh.distance(points, signed=True)


def test_self_intersections_and_surfaces():
    assert cube().self_intersections().shape == (0, 2)
    both = collide.Mesh(numpy.concatenate([CUBE, CUBE + 0.5]), numpy.concatenate([FACES, FACES + 8]))
    pairs = both.self_intersections()
    assert len(pairs) > 0 and pairs.dtype == numpy.int32 and (pairs[:, 0] < 12).all() and (pairs[:, 1] >= 12).all()
    inside_of_both = numpy.full((1, 3), 0.75)
    assert not both.contains(inside_of_both)[0] and both.winding_number(inside_of_both).value[0] > 1.9
    middle = numpy.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [1, 0, 0], [1, -1, 0]], float)
    surface = collide.Mesh(middle, numpy.array([[0, 1, 2], [0, 4, 3]])).validate_surface(1e-9)
    assert surface.hanging_nodes.tolist() == [[0, 1]] and surface.cracks.shape == (0, 2) and "hangs" in surface.message
    with pytest.raises(collide.Error, match="tolerance"):
        cube().validate_surface(-1)


@FLOATS
def test_distances_alone(dtype):
    """70,000 points, which are more than one portion."""
    mesh, points = cube(dtype), random_points(70_000, dtype)
    assert numpy.array_equal(mesh.distance(points), mesh.nearest(points).distance)
    found = mesh.signed_distance(points, max_distance=0.3).distance
    out = numpy.empty(len(points), dtype)
    assert mesh.distance(points, signed=True, max_distance=0.3, out=out) is out and numpy.array_equal(out, found)
    assert mesh.distance(points).dtype == dtype and mesh.distance(points[:0]).shape == (0,)
    with pytest.raises(TypeError, match="out: has dtype int32"):
        mesh.distance(points[:2], out=numpy.zeros(2, numpy.int32))


@FLOATS
def test_winding_numbers_of_a_closed_mesh_tell_its_inside(dtype):
    mesh, points = cube(dtype), random_points(2000, dtype)
    found = mesh.winding_number(points, beta=numpy.inf)
    assert numpy.array_equal(found.value > 0.5, mesh.contains(points))
    assert (abs(found.value - numpy.round(found.value)) <= found.error).all() and found.error.max() < 1e-3
    with pytest.raises(ValueError, match="beta: is below 2"):
        mesh.winding_number(points, beta=1)


@FLOATS
def test_poses_are_as_if_points_moved(dtype):
    """Half turns and shifts of dyadic numbers are exact, so that all answers are."""
    mesh = cube(dtype)
    points = (numpy.random.default_rng(5).integers(-64, 96, (400, 3)) / 64).astype(dtype)
    turn = numpy.array([-1, -1, 1], dtype)  # around z
    pose = [[1, 2, 3, 0, 0, 0, 1]]
    there = points * turn + numpy.array([1, 2, 3], dtype)
    assert mesh.count(there, 0.25, poses=pose) == mesh.count(points, 0.25) > 0
    assert numpy.array_equal(mesh.any(there, 0.25, poses=pose), mesh.any(points, 0.25))
    for mine, other in zip(mesh.query(there, 0.25, poses=pose, order="canonical"), mesh.query(points, 0.25, order="canonical")):
        assert numpy.array_equal(mine, other)
    rows, others = (mesh.query(x, 0.25, output="csr", order="canonical", poses=p) for x, p in ((there, pose), (points, None)))
    assert numpy.array_equal(rows.offsets, others.offsets) and numpy.array_equal(rows.triangle, others.triangle)
    mine, other = mesh.contacts(there, 0.25, poses=pose, order="canonical"), mesh.contacts(points, 0.25, order="canonical")
    assert numpy.array_equal(mine.distance, other.distance) and numpy.array_equal(mine.normal, other.normal * turn)
    mine, other = mesh.nearest(there, poses=pose), mesh.nearest(points)
    assert numpy.array_equal(mine.triangle, other.triangle) and numpy.array_equal(mine.distance, other.distance)
    assert numpy.allclose(mine.point, other.point * turn + numpy.array([1, 2, 3]), atol=1e-6)
    mine, other = mesh.k_nearest(there, 5, poses=pose), mesh.k_nearest(points, 5)
    assert numpy.array_equal(mine.triangle, other.triangle) and numpy.array_equal(mine.distance, other.distance)
    assert numpy.allclose(mine.point, other.point * turn + numpy.array([1, 2, 3]), atol=1e-6)
    paths = numpy.roll(points, 1, axis=0)
    for options in {"order": "canonical"}, {"first": True}:
        mine, other = mesh.impacts(there, paths * turn, 0.25, poses=pose, **options), mesh.impacts(points, paths, 0.25, **options)
        assert numpy.array_equal(mine.sphere, other.sphere) and numpy.array_equal(mine.triangle, other.triangle)
        assert len(mine) > 100 and numpy.array_equal(mine.time, other.time)
        assert numpy.array_equal(mine.normal, other.normal * turn, equal_nan=True)
    assert numpy.array_equal(mesh.contains(there, poses=pose), mesh.contains(points))
    assert numpy.array_equal(mesh.distance(there, signed=True, poses=pose), mesh.signed_distance(points).distance)
    assert numpy.array_equal(mesh.signed_distance(there, poses=pose).distance, mesh.signed_distance(points).distance)


def test_bodies_in_poses():
    """Two cubes as bodies of one mesh are two meshes."""
    both = collide.Mesh(numpy.concatenate([CUBE, CUBE]), numpy.concatenate([FACES, FACES + 8]), bodies=[(0, 12), (12, 12)])
    poses = numpy.array([[0, 0, 0, 1, 0, 0, 0], [2, 0, 0, 1, 0, 0, 0]], float)
    points = random_points(300) * [2, 1, 1]
    assert numpy.array_equal(both.contains(points, poses=poses), cube().contains(points) | cube(at=(2, 0, 0)).contains(points))
    assert both.count(points, 0.1, poses=poses) == cube().count(points, 0.1) + cube(at=(2, 0, 0)).count(points, 0.1)
    rows = both.k_nearest(points, 4, poses=poses)
    alone = [m.k_nearest(points, 4).distance for m in (cube(), cube(at=(2, 0, 0)))]
    assert numpy.array_equal(rows.distance, numpy.sort(numpy.concatenate(alone, axis=1), axis=1)[:, :4])
    with pytest.raises(ValueError, match="poses: there are 1, expected 2"):
        both.any(points, 0.1, poses=poses[:1])
    with pytest.raises(TypeError, match=r"poses: expected numbers of shape \(bodies, 7\)"):
        both.any(points, 0.1, poses="here")
    with pytest.raises(collide.Error, match="no unit quaternion"):
        both.any(points, 0.1, poses=poses * 2)
    with pytest.raises(ValueError, match="displacements: of a mesh in poses are for impacts"):
        both.any(points, 0.1, poses=poses, displacements=points)
    with pytest.raises(collide.Error, match="collide"):
        collide.Mesh(CUBE, FACES, bodies=[(0, 13)]).any(points, 0.1, poses=poses[:1])
    with pytest.raises(TypeError, match="bodies: expected pairs"):
        cube(bodies=[1, 2])


def test_short_lists_are_arrays():
    mesh = collide.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert mesh.any([[0.2, 0.2, 0.1], [3, 3, 3]], [0.5, 0.1]).tolist() == [True, False]
    assert mesh.any([(0.2, 0.2, 2)], 0.5, displacements=[(0, 0, -2)]).tolist() == [True]
    assert mesh.nearest([[0, 0, 2]]).distance.tolist() == [2]
    mesh.update([[0, 0, 1], [1, 0, 1], [0, 1, 1]])
    assert mesh.nearest([[0, 0, 2]]).distance.tolist() == [1]
    with pytest.raises(ValueError, match="centres: is a list of 3000 numbers"):
        mesh.any([[0, 0, 0]] * 1000, 1)
    for wrong in ([[0, 0], [1]], ["a"], [None, {}]):
        with pytest.raises(TypeError, match="centres: expected an array, or a list"):
            mesh.any(wrong, 1)


def test_meshes_of_other_libraries():
    """Objects with the attributes of theirs; the libraries themselves where they are installed."""
    quads = {"quad": numpy.array(QUADS), "triangle": FACES}
    like = types.SimpleNamespace
    meshes = [
        like(vertices=CUBE, faces=FACES),  # trimesh
        like(vertices=CUBE.tolist(), triangles=FACES.astype(numpy.int32)),  # Open3D
        like(vertex=like(positions=CUBE), triangle=like(indices=FACES)),  # Open3D's tensors
        like(points=CUBE, cells_dict={"triangle": FACES, "line": FACES[:, :2]}),  # meshio
        like(points=CUBE, faces=numpy.insert(FACES, 0, 3, axis=1).reshape(-1)),  # PyVista
    ]
    makers = {
        "trimesh": lambda m: m.Trimesh(CUBE, FACES, process=False),
        "meshio": lambda m: m.Mesh(CUBE, [("triangle", FACES)]),
        "pyvista": lambda m: m.PolyData(CUBE, numpy.insert(FACES, 0, 3, axis=1).reshape(-1)),
        "open3d": lambda m: m.geometry.TriangleMesh(m.utility.Vector3dVector(CUBE), m.utility.Vector3iVector(FACES.astype(numpy.int32))),
    }
    for name, make in makers.items():
        try:
            meshes.append(make(__import__(name)))
        except ImportError:
            pass
    points = random_points(50)
    for mesh in meshes:
        assert numpy.array_equal(collide.Mesh.of(mesh).signed_distance(points).distance, cube().signed_distance(points).distance)
    assert len(collide.Mesh.from_trimesh(meshes[0], threads=1)) == 12
    with pytest.raises(ValueError, match="mesh: has cells that are no triangles: quad"):
        collide.Mesh.of(like(points=CUBE, cells_dict=quads))
    with pytest.raises(ValueError, match="mesh: has faces that are no triangles: call its triangulate"):
        collide.Mesh.of(like(points=CUBE, faces=numpy.insert(numpy.array(QUADS), 0, 4, axis=1).reshape(-1)))
    with pytest.raises(TypeError, match="mesh: expected one of trimesh"):
        collide.Mesh.of(CUBE)


def test_gradients_for_torch():
    torch = pytest.importorskip("torch")
    from collide import autograd

    vertices, faces = torch.tensor(CUBE, requires_grad=True), torch.tensor(FACES)
    points = torch.tensor(random_points(60), requires_grad=True)  # at faces, edges and corners, inside and outside
    kinds = collide.Mesh(vertices.detach(), faces).nearest(points.detach()).feature
    assert set(kinds.tolist()) == {0, 1, 2}
    check, options = torch.autograd.gradcheck, {"eps": 1e-7, "atol": 1e-5}
    assert check(lambda p, v: autograd.signed_distance(p, v, faces), (points, vertices), **options)
    assert check(lambda p, v: autograd.nearest(p, v, faces), (points, vertices), **options)
    assert torch.autograd.gradgradcheck(lambda p: autograd.nearest(p, vertices.detach(), faces)[1], (points,), atol=1e-4)
    kept = collide.Mesh(vertices.detach(), faces)
    assert torch.equal(autograd.signed_distance(points, vertices, faces, kept), kept.signed_distance(points.detach()).distance)
    first = torch.autograd.grad(autograd.signed_distance(points, vertices, faces).square().sum(), points, create_graph=True)[0]
    with pytest.raises(RuntimeError, match="once_differentiable"):
        first.sum().backward()
    on_it = torch.tensor([[0.5, 0.25, 1.0]], dtype=torch.float64, requires_grad=True)
    autograd.nearest(on_it, vertices, faces)[1].sum().backward()
    assert (on_it.grad == 0).all()
