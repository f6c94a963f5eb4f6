"""bench.py [SCENE FILE]: what a call from Python costs beyond the library, on the host and on a GPU.

Times are medians of 50 calls after 5, in microseconds, in one process. ../bench/host.py measures other libraries. A scene
file is one that `python_reference NAME SPHERES TRIANGLES FILE` writes; without one there are random triangles. Calls with
one sphere are almost all what Python adds.
"""

import pathlib
import statistics
import sys
import time

import numpy

import collide


def microseconds(call, wait=lambda: None, n=50):
    times = []
    for _ in range(n + 5):
        wait()
        begin = time.perf_counter()
        call()
        wait()
        times.append((time.perf_counter() - begin) * 1e6)
    return statistics.median(times[5:])


def show(name, value):
    print(f"{name:45} {value:12.1f} us", flush=True)


def of_one_sphere(put, wait, what):
    """Almost all of it is what Python adds."""
    mesh = collide.Mesh(put(numpy.eye(3, dtype=numpy.float32)), put(numpy.array([[0, 1, 2]], numpy.int32)))
    centre = put(numpy.zeros((1, 3), numpy.float32))
    for name in ("any", "count", "query", "contacts"):
        show(f"{what}: {name} of one sphere", microseconds(lambda: getattr(mesh, name)(centre, 1.0), wait, 500))


def main():
    sys.path.insert(0, str(pathlib.Path(__file__).parent))
    if len(sys.argv) > 1:
        from conftest import read_scene

        s = read_scene(pathlib.Path(sys.argv[1])).of(numpy.float32)
        vertices, triangles, centres, radius = s.vertices, s.triangles.view(numpy.int32), s.centres, s.radius
    else:
        random = numpy.random.default_rng(0)
        corners = random.uniform(0, 1, (20_000, 1, 3)) + random.normal(0, 0.005, (20_000, 3, 3))
        vertices, triangles = corners.reshape(-1, 3).astype(numpy.float32), numpy.arange(60_000, dtype=numpy.int32).reshape(-1, 3)
        centres, radius = random.uniform(0, 1, (500_000, 3)).astype(numpy.float32), 0.005
    of_one_sphere(lambda a: a, lambda: None, "numpy")
    mesh = collide.Mesh(vertices, triangles)
    for name in ("any", "query"):
        show(f"numpy: {name}", microseconds(lambda: getattr(mesh, name)(centres, radius), n=10))
    from collide import _arrays

    if _arrays._cuda is None or _arrays._cuda.device_count() == 0:
        return
    import torch

    put = lambda a: torch.from_numpy(a.copy()).cuda() if isinstance(a, numpy.ndarray) else a
    of_one_sphere(put, torch.cuda.synchronize, "torch on a GPU")
    mesh, x, r, v = collide.Mesh(put(vertices), put(triangles)), put(centres), put(radius), put(vertices)

    def build_and_query():
        mesh.update(v)
        mesh.query(x, r)

    for name in ("any", "query"):
        show(f"torch on a GPU: {name}", microseconds(lambda: getattr(mesh, name)(x, r), torch.cuda.synchronize))
    show("torch on a GPU: update and query", microseconds(build_and_query, torch.cuda.synchronize))


if __name__ == "__main__":
    main()
