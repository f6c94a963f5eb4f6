"""The arrays of other libraries on the host: torch, jax and warp, as far as they are installed."""

import numpy
import pytest

import collide

VERTICES = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TRIANGLES = numpy.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]], numpy.int32)


def torch_array(array):
    return pytest.importorskip("torch").from_numpy(array.copy())


def jax_array(array):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    with jax.default_device(jax.devices("cpu")[0]):
        return jax.numpy.array(array)


def warp_array(array):
    warp = pytest.importorskip("warp")
    warp.config.quiet = True
    return warp.array(array, dtype=getattr(warp, str(array.dtype)), device="cpu")


MAKE = {"torch": torch_array, "jax": jax_array, "warp": warp_array}


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.float64])
@pytest.mark.parametrize("library", MAKE)
def test_results_are_of_the_library_that_asks(library, dtype):
    make = MAKE[library]
    random = numpy.random.default_rng(0)
    centres, moves = (random.uniform(-0.5, 1.5, (200, 3)).astype(dtype) for _ in range(2))
    radii = random.uniform(0, 0.4, 200).astype(dtype)
    expected = collide.Mesh(VERTICES.astype(dtype), TRIANGLES)
    mesh = collide.Mesh(make(VERTICES.astype(dtype)), make(TRIANGLES))
    x, d, r = make(centres), make(moves), make(radii)

    def same(mine, other):
        assert type(mine) is type(x)
        assert numpy.array_equal(numpy.asarray(mine.numpy() if hasattr(mine, "numpy") else mine), other, equal_nan=True)

    assert mesh.count(x, r) == expected.count(centres, radii)
    same(mesh.any(x, r), expected.any(centres, radii))
    for mine, other in zip(mesh.query(x, r, order="canonical"), expected.query(centres, radii, order="canonical")):
        same(mine, other)
    rows = mesh.query(x, 0.2, output="csr", order="canonical")
    for mine, other in zip(rows, expected.query(centres, 0.2, output="csr", order="canonical")):
        same(mine, other)
    mine, other = mesh.impacts(x, d, r, first=True), expected.impacts(centres, moves, radii, first=True)
    for name in ("sphere", "triangle", "point", "normal", "distance", "depth", "feature", "feature_index", "time"):
        same(getattr(mine, name), getattr(other, name))
    same(mesh.contains(x), expected.contains(centres))
    near = [(m.nearest(p), m.k_nearest(p, 3), m.signed_distance(p)) for m, p in ((mesh, x), (expected, centres))]
    for mine, other in zip(*near):
        for name in ("triangle", "distance", "point", "barycentric", "feature", "feature_index"):
            same(getattr(mine, name), getattr(other, name))
    same(near[0][2].gradient, near[1][2].gradient)
    assert len(mesh.query(x[:0], 0.1)) == len(mesh.k_nearest(x[:0], 2)) == 0


@pytest.mark.parametrize("library", MAKE)
def test_simulation(library):
    make = MAKE[library]
    mesh = collide.Mesh(make(VERTICES.astype(numpy.float32)), make(TRIANGLES))
    sim = collide.Simulation(mesh, [collide.gravity(0, 0, -1)])
    x = make(numpy.zeros((2, 3), numpy.float32))
    sim.set(x, 0.1)
    sim.step(0.5)
    velocity = sim["velocity"]
    assert type(velocity) is type(x)
    assert numpy.asarray(velocity.numpy() if hasattr(velocity, "numpy") else velocity).tolist() == [[0, 0, -0.5]] * 2


def test_torch_tensors_with_gradients():
    """Old versions refuse to share them, and say so; new ones do."""
    torch = pytest.importorskip("torch")
    mesh = collide.Mesh(torch.from_numpy(VERTICES.astype(numpy.float32)), torch.from_numpy(TRIANGLES))
    try:
        assert mesh.count(torch.zeros(2, 3, requires_grad=True), 1) == 8
    except TypeError as error:
        assert "centres: cannot be shared without a copy" in str(error) and "grad" in str(error)


def test_torch_strides_and_out():
    torch = pytest.importorskip("torch")
    mesh = collide.Mesh(torch.from_numpy(VERTICES.astype(numpy.float32)), torch.from_numpy(TRIANGLES))
    centres = torch.rand(100, 4)
    out = torch.zeros(100, dtype=torch.uint8)
    assert mesh.any(centres[:, :3], 0.1, out=out) is out
    assert out.sum() == mesh.any(centres[:, :3].contiguous(), 0.1).sum()
    out = torch.zeros(1000, 2, dtype=torch.int32)
    pairs = mesh.query(centres[:, :3], centres[:, 3], out=out)
    assert pairs.records.data_ptr() == out.data_ptr() and pairs.complete


@pytest.mark.parametrize("vector, dtype", [("vec3f", numpy.float32), ("vec3d", numpy.float64)])
def test_vectors_of_warp(vector, dtype):
    """Its usual arrays of points are of vectors: (n,) for warp, (n, 3) for all others. They are read where they are."""
    warp = pytest.importorskip("warp")
    warp.config.quiet = True
    put = lambda array: warp.array(array, dtype=getattr(warp, vector), device="cpu")
    corners = warp.array(TRIANGLES.ravel(), dtype=warp.int32, device="cpu")
    vertices, centres = put(VERTICES), put(VERTICES + 0.25)
    mesh, same = collide.Mesh(vertices, corners.reshape((-1, 3))), collide.Mesh(VERTICES.astype(dtype), TRIANGLES)
    contacts = mesh.contacts(centres, 0.5, order="canonical")
    expected = same.contacts((VERTICES + 0.25).astype(dtype), 0.5, order="canonical")
    assert len(contacts) > 0 and numpy.array_equal(contacts.point.numpy(), expected.point)
    vertices.numpy()[:] += 9  # a view
    mesh.update(vertices)
    assert mesh.count(centres, 0.5) == 0


def test_any_object_with_dlpack():
    class Array:
        def __init__(self, of):
            self.of = of

        def __dlpack__(self, **options):
            return self.of.__dlpack__(**options)

        def __dlpack_device__(self):
            return self.of.__dlpack_device__()

    mesh = collide.Mesh(Array(VERTICES.astype(numpy.float32)), TRIANGLES)
    assert mesh.any(Array(VERTICES.astype(numpy.float32)), 0.1).tolist() == [True] * 4
    assert collide.Mesh(Array(VERTICES.astype(float)), TRIANGLES).any(VERTICES.astype(float), 0.1).tolist() == [True] * 4
    with pytest.raises(TypeError, match="triangles: has dtype float32"):
        collide.Mesh(Array(VERTICES.astype(numpy.float32)), Array(VERTICES.astype(numpy.float32)))
