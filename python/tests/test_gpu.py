"""Arrays on a GPU: of torch, cupy, jax and warp. Skipped where there is no GPU, or the package has no CUDA."""

import multiprocessing
import os
import subprocess
import sys

import numpy
import pytest

import collide
from collide import _arrays
from conftest import SCENES

HAS_GPU = _arrays._cuda is not None and _arrays._cuda.device_count() > 0
pytestmark = pytest.mark.skipif(not HAS_GPU, reason="there is no GPU, or the package is the one for the host")

VERTICES = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TRIANGLES = numpy.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]], numpy.int32)


class Torch:
    def __init__(self):
        self.torch = pytest.importorskip("torch")

    def put(self, array):
        return self.torch.from_numpy(array.copy()).cuda()

    def get(self, array):
        return array.cpu().numpy()


class Cupy:
    def __init__(self):
        self.cupy = pytest.importorskip("cupy")

    def put(self, array):
        return self.cupy.asarray(array)

    def get(self, array):
        return self.cupy.asnumpy(array)


class Jax:
    def __init__(self):
        self.jax = pytest.importorskip("jax")
        self.jax.config.update("jax_enable_x64", True)
        if self.jax.default_backend() != "gpu":
            pytest.skip("jax has no GPU")

    def put(self, array):
        return self.jax.numpy.array(array)

    def get(self, array):
        return numpy.asarray(array)


class Warp:
    def __init__(self):
        self.warp = pytest.importorskip("warp")
        self.warp.config.quiet = True

    def put(self, array):
        return self.warp.array(array, dtype=getattr(self.warp, str(array.dtype)), device="cuda:0")

    def get(self, array):
        return array.numpy()


@pytest.fixture(params=[Torch, Cupy, Jax, Warp], ids=["torch", "cupy", "jax", "warp"])
def library(request):
    return request.param()


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.float64])
def test_results_are_those_of_the_host(library, dtype):
    random = numpy.random.default_rng(0)
    centres, moves = (random.uniform(-0.5, 1.5, (2000, 3)).astype(dtype) for _ in range(2))
    radii = random.uniform(0, 0.4, 2000).astype(dtype)
    host = collide.Mesh(VERTICES.astype(dtype), TRIANGLES)
    mesh = collide.Mesh(library.put(VERTICES.astype(dtype)), library.put(TRIANGLES))
    x, d, r = library.put(centres), library.put(moves), library.put(radii)

    def same(mine, other):
        assert type(mine) is type(x)
        assert numpy.array_equal(library.get(mine), other, equal_nan=True)

    assert mesh.count(x, r) == host.count(centres, radii) and "GPU 0" in repr(mesh)
    same(mesh.any(x, r), host.any(centres, radii))
    for precision in ("exact", "double", "single"):
        a = mesh.query(x, r, order="canonical", precision=precision)
        for mine, other in zip(a, host.query(centres, radii, order="canonical", precision=precision)):
            same(mine, other)
    for mine, other in zip(
        mesh.query(x, 0.2, output="csr", order="canonical"), host.query(centres, 0.2, output="csr", order="canonical")
    ):
        same(mine, other)
    contacts = [(mesh.contacts(x, r, closest=True), host.contacts(centres, radii, closest=True))]
    contacts += [(mesh.contacts(x, r, order="canonical"), host.contacts(centres, radii, order="canonical"))]
    contacts += [(mesh.impacts(x, d, r, first=True), host.impacts(centres, moves, radii, first=True))]
    contacts += [(mesh.impacts(x, d, r, order="canonical"), host.impacts(centres, moves, radii, order="canonical"))]
    for mine, other in contacts:
        same(mine.records, other.records)
        for name in ("sphere", "triangle", "point", "normal", "distance", "depth", "feature", "feature_index"):
            same(getattr(mine, name), getattr(other, name))
    same(contacts[-1][0].time, contacts[-1][1].time)
    same(mesh.contains(x), host.contains(centres))
    for mine, other in (
        (mesh.nearest(x), host.nearest(centres)), (mesh.k_nearest(x, 3), host.k_nearest(centres, 3)),
        (mesh.signed_distance(x), host.signed_distance(centres)),
    ):
        for name in ("triangle", "distance", "point", "barycentric", "feature", "feature_index"):
            same(getattr(mine, name), getattr(other, name))
    same(mine.gradient, other.gradient)
    assert len(mesh.query(library.put(centres[:0]), 0.1)) == 0


@pytest.mark.parametrize("name", SCENES)
def test_scenes(name, scene):
    torch = pytest.importorskip("torch")
    s = scene(name).of(numpy.float32)
    host = collide.Mesh(s.vertices, s.triangles)
    put = lambda a: torch.from_numpy(a.copy()).cuda() if isinstance(a, numpy.ndarray) else a
    mesh = collide.Mesh(put(s.vertices), put(s.triangles.view(numpy.int32)))
    for mine, other in (
        (mesh.query(put(s.centres), put(s.radius), order="canonical"), host.query(s.centres, s.radius, order="canonical")),
        (mesh.contacts(put(s.centres), put(s.radius), order="canonical"), host.contacts(s.centres, s.radius, order="canonical")),
        (mesh.contacts(put(s.centres), put(s.radius), closest=True), host.contacts(s.centres, s.radius, closest=True)),
    ):
        assert mine.total == other.total and numpy.array_equal(mine.records.cpu().numpy(), other.records)
    mine, other = mesh.signed_distance(put(s.centres)), host.signed_distance(s.centres)
    assert torch.equal(mine.triangle.cpu(), torch.from_numpy(other.triangle))
    assert torch.equal(mine.distance.cpu(), torch.from_numpy(other.distance))


def test_results_outlive_the_mesh(library):
    mesh = collide.Mesh(library.put(VERTICES.astype(numpy.float32)), library.put(TRIANGLES))
    centres = library.put(numpy.random.default_rng(0).uniform(-0.5, 1.5, (2000, 3)).astype(numpy.float32))
    contacts = mesh.contacts(centres, 0.3, order="canonical")
    point, before = contacts.point, library.get(contacts.point).copy()
    del contacts, mesh
    for _ in range(5):
        other = collide.Mesh(library.put(VERTICES.astype(numpy.float32) + 1), library.put(TRIANGLES))
        other.contacts(centres, 0.3)
    assert numpy.array_equal(library.get(point), before)


def test_work_is_in_the_order_of_streams():
    """On a stream of one's own, what was put there before is done before the query, and what comes after sees results."""
    torch = pytest.importorskip("torch")
    mesh = collide.Mesh(torch.from_numpy(VERTICES.astype(numpy.float32)).cuda(), torch.from_numpy(TRIANGLES).cuda())
    n = 1_000_000
    far, near = torch.full((n, 3), 9.0, device="cuda"), torch.zeros((n, 3), device="cuda")
    big = torch.rand(4096, 4096, device="cuda")
    torch.cuda.synchronize()
    for stream in [torch.cuda.Stream() for _ in range(3)] + [torch.cuda.default_stream()]:
        with torch.cuda.stream(stream):
            centres = far.clone()
            for _ in range(20):
                big @ big  # the stream is busy
            centres.copy_(near)
            flags = mesh.any(centres, 0.1)
            centres.copy_(far)
            touched = flags.sum()
            assert mesh.count(centres, 0.1) == 0
        assert touched.item() == n


def test_jax_in_the_middle_of_its_work():
    jax = Jax().jax
    mesh = collide.Mesh(jax.numpy.array(VERTICES, "float32"), jax.numpy.array(TRIANGLES))

    @jax.jit
    def slow(x):
        big = jax.numpy.ones((4096, 4096), "float32")
        for _ in range(10):
            big = big @ big / 4096
        return x * 0 + big[0, 0] * 0

    for _ in range(5):
        centres = slow(jax.numpy.full((200_000, 3), 9.0, "float32"))
        flags = mesh.any(centres, 0.1)
        del centres
        assert int(flags.sum()) == 200_000


def test_a_graph_of_any():
    torch = pytest.importorskip("torch")
    mesh = collide.Mesh(torch.from_numpy(VERTICES.astype(numpy.float32)).cuda(), torch.from_numpy(TRIANGLES).cuda())
    centres, out = torch.zeros((1000, 3), device="cuda"), torch.zeros(1000, dtype=torch.uint8, device="cuda")
    side = torch.cuda.Stream()
    with torch.cuda.stream(side):
        mesh.any(centres, 0.1, out=out)
    torch.cuda.synchronize()
    graph = torch.cuda.CUDAGraph()
    with torch.cuda.graph(graph, stream=side):
        mesh.any(centres, 0.1, out=out)
    for place, touched in ((9, 0), (0, 1000), (9, 0)):
        centres.fill_(place)
        graph.replay()
        assert out.sum().item() == touched
    assert mesh.count(centres, 0.1) == 0


def test_out_and_capacity():
    torch = pytest.importorskip("torch")
    mesh = collide.Mesh(torch.from_numpy(VERTICES.astype(numpy.float32)).cuda(), torch.from_numpy(TRIANGLES).cuda())
    centres = torch.rand(1000, 4, device="cuda")
    everything = mesh.query(centres[:, :3], centres[:, 3], order="canonical")
    few = mesh.query(centres[:, :3], centres[:, 3], order="canonical", capacity=7)
    assert len(few) == 7 and few.total == len(everything) and torch.equal(few.records, everything.records[:7])
    room = torch.zeros(len(everything), 2, dtype=torch.int32, device="cuda")
    mesh.query(centres[:, :3], centres[:, 3], order="canonical", out=room)
    assert torch.equal(room, everything.records)


def test_devices_are_not_mixed(library):
    mesh = collide.Mesh(library.put(VERTICES.astype(numpy.float32)), library.put(TRIANGLES))
    centres = VERTICES.astype(numpy.float32)
    with pytest.raises((ValueError, TypeError), match="centres: "):
        mesh.count(centres, 1)
    with pytest.raises(ValueError, match="triangles: .* but the mesh is on the host"):
        collide.Mesh(centres, library.put(TRIANGLES))
    host = collide.Mesh(centres, TRIANGLES)
    with pytest.raises((ValueError, TypeError), match="centres: "):
        host.count(library.put(centres), 1)


def test_vectors_of_warp():
    """Points as warp's own programs have them; and work on the null stream."""
    warp = Warp().warp
    vertices, centres = (warp.array(a, dtype=warp.vec3, device="cuda:0") for a in (VERTICES, VERTICES + 0.25))
    corners = warp.array(TRIANGLES.ravel(), dtype=warp.int32, device="cuda:0")
    for stream in (warp.get_stream("cuda:0"), warp.get_device("cuda:0").null_stream):
        with warp.ScopedStream(stream):
            mesh = collide.Mesh(vertices, corners.reshape((-1, 3)))
            found = mesh.contacts(centres, 0.5, order="canonical").point
        host = collide.Mesh(VERTICES.astype(numpy.float32), TRIANGLES)
        points = host.contacts((VERTICES + 0.25).astype(numpy.float32), 0.5, order="canonical").point
        assert len(points) > 0 and numpy.array_equal(found.numpy(), points)


def test_triangles_are_checked(library):
    with pytest.raises(ValueError, match="triangles: .* not a vertex"):
        collide.Mesh(library.put(VERTICES.astype(numpy.float32)), library.put(TRIANGLES + 1))


def simulate(put, effects, **options):
    square = numpy.array([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], numpy.float32)
    mesh = collide.Mesh(put(square), put(TRIANGLES[:2] * 0 + numpy.array([[0, 1, 2], [0, 2, 3]], numpy.int32)))
    sim = collide.Simulation(mesh, effects, **options)
    x = numpy.random.default_rng(0).uniform(-2, 2, (500, 3)).astype(numpy.float32) + numpy.float32([0, 0, 2.15])  # some reach the floor
    sim.set(put(x), 0.1)
    sim.steps(300, 1e-3)
    return sim


@pytest.mark.parametrize(
    "effects",
    [
        [collide.gravity(), collide.bounce(0.5)],  # in the package
        [collide.gravity(), collide.sphere_contact(1000, density=100), collide.bounce(), collide.friction()],
        [  # compiled by nvcc
            collide.gravity(), collide.drag(0.5), collide.bounce(0.3), collide.mass_flow((0, 0, 2), (0, 0, -1), 1e-9),
            collide.reaction(1e-9, triangles=True),
        ],
    ],
)
def test_simulations_have_the_bits_of_the_host(library, effects):
    host, sim = simulate(lambda a: a, effects), simulate(library.put, effects)
    for name in host.columns:
        column = sim[name]
        assert type(column) is type(library.put(VERTICES))
        assert numpy.array_equal(library.get(column), host[name])
    for name in [effect.name for effect in effects if effect.name in ("mass_flow", "reaction")]:
        mine, other = sim.sums(name), host.sums(name)
        assert numpy.any(mine[0]) and all(numpy.array_equal(a, b) for a, b in zip(mine, other))
        sim.clear(name)
        assert not numpy.any(sim.sums(name)[0])
    sim["velocity"] = library.put(numpy.ones((500, 3), numpy.float32))
    assert (library.get(sim["velocity"]) == 1).all()
    old = sim["position"]  # of jax a copy
    before = library.get(old).copy()
    sim.set(library.put(numpy.zeros((2, 3), numpy.float32) + 1), 0.1)
    sim.step(1e-3)
    assert numpy.array_equal(library.get(old), before) and len(sim) == 2


def in_a_child(queue, mesh, centres):
    try:
        queue.put(mesh.count(centres, 1))
    except collide.Error as error:
        host = collide.Mesh(VERTICES.astype(numpy.float32), TRIANGLES)
        queue.put((str(error), host.count(VERTICES.astype(numpy.float32), 0.1)))


def test_forked_processes_say_what_is_wrong():
    torch = pytest.importorskip("torch")
    mesh = collide.Mesh(torch.from_numpy(VERTICES.astype(numpy.float32)).cuda(), torch.from_numpy(TRIANGLES).cuda())
    centres = torch.zeros(5, 3, device="cuda")
    mesh.count(centres, 1)
    fork = multiprocessing.get_context("fork")
    queue = fork.Queue()
    child = fork.Process(target=in_a_child, args=(queue, mesh, centres))
    child.start()
    text, count = queue.get(timeout=60)
    child.join(60)
    assert "forked" in text and "spawn" in text and count == 12


END = """
import threading, time, torch, collide
mesh = collide.Mesh(torch.rand(30000, 3, device='cuda'))
centres = torch.rand(100000, 3, device='cuda')
def work():
    while True:
        mesh.any(centres, 0.01)
threading.Thread(target=work, daemon=True).start()
time.sleep(0.3)
kept = mesh.query(centres, 0.01)
print('ends')
"""


def test_the_interpreter_ends_with_work_under_way():
    pytest.importorskip("torch")
    for _ in range(3):
        done = subprocess.run([sys.executable, "-c", END], capture_output=True, text=True, timeout=300, env=os.environ)
        assert (done.returncode, done.stdout.strip()) == (0, "ends"), done.stderr


def test_no_memory_is_lost():
    torch = pytest.importorskip("torch")
    mesh = collide.Mesh(torch.rand(3000, 3, device="cuda"))
    centres = torch.rand(100_000, 3, device="cuda")
    free = []
    for _ in range(2):
        for _ in range(100):
            mesh.contacts(centres, 0.01)
            mesh.query(centres, 0.01, capacity=1000)
        torch.cuda.synchronize()
        free.append(torch.cuda.mem_get_info()[0])
    assert free[0] - free[1] < 64 << 20
