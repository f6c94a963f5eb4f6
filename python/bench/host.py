"""host.py REFERENCE [OUT.json] [SCENE ...]: queries from numpy beside trimesh, Open3D, libigl and FCPW, on one core of the host.

REFERENCE is the program of python/tests/reference.cpp, which makes the scenes. Prints what it measures, and writes
bench/results/host-python.json, of which bench/report makes the table of docs/python.md. Needs pytest and hypothesis, as
the tests do, whose rational numbers it uses. Libraries that are not installed are skipped. Times are the least processor
time of some calls, with what a library builds of the mesh apart, so that other work on the machine matters little. Wrong
answers are counted with rational numbers, which decide every point on which a library and this one differ:

- any: spheres that the distance of a library, compared with the radius, puts on the other side;
- nearest: points whose triangle is farther away than another one; of equally near ones any is right;
- inside: points on the wrong side. A point on the surface is on neither.
"""

import datetime
import fractions
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
import time

os.environ["OMP_NUM_THREADS"] = "1"
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # before libraries make threads

import numpy

import collide

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "tests"))
from conftest import read_scene
from test_nearest import squared_distances

SCENES = {"study": (200_000, 62_976), "camera": (100_000, 30_000), "soup": (100_000, 200_000)}
CLOSED = "study"  # the only one with an inside
MOST = 2000  # points whose triangles or sides rational numbers check
FEW = 200  # points of trimesh, which is slow


def least(call, n=3):
    """The least processor time of a call in ms, and its result."""
    times = []
    for _ in range(n):
        begin = time.process_time()
        result = call()
        times.append((time.process_time() - begin) * 1e3)
    return min(times), result


class Collide:
    """This library."""

    name, most = "collide", None

    def build(self, v, t):
        self.mesh = collide.Mesh(v, t)
        self.mesh.nearest(v[:1])

    def touches(self, p, radius):
        return self.mesh.any(p, radius)

    def nearest(self, p):
        return self.mesh.nearest(p).triangle

    def inside(self, p):
        return self.mesh.signed_distance(p).distance < 0


class Open3d:
    name, most = "Open3D", None

    def __init__(self):
        import open3d

        self.open3d, self.version = open3d, open3d.__version__

    def build(self, v, t):
        self.scene = self.open3d.t.geometry.RaycastingScene(nthreads=1)
        self.scene.add_triangles(v, t.astype(numpy.uint32))
        self.scene.compute_distance(v[:1])

    def touches(self, p, radius):
        return self.scene.compute_distance(p, nthreads=1).numpy() <= radius

    def nearest(self, p):
        return self.scene.compute_closest_points(p, nthreads=1)["primitive_ids"].numpy().astype(int)

    def inside(self, p):
        return self.scene.compute_signed_distance(p, nthreads=1).numpy() < 0


class Trimesh:
    name, most = "trimesh", FEW

    def __init__(self):
        import trimesh

        self.trimesh, self.version = trimesh, trimesh.__version__

    def build(self, v, t):
        self.mesh = self.trimesh.Trimesh(v, t, process=False)
        self.trimesh.proximity.closest_point(self.mesh, v[:1])

    def touches(self, p, radius):
        return self.trimesh.proximity.closest_point(self.mesh, p)[1] <= radius

    def nearest(self, p):
        return self.trimesh.proximity.closest_point(self.mesh, p)[2]

    def inside(self, p):
        return self.trimesh.proximity.signed_distance(self.mesh, p) > 0


class Libigl:
    name, most = "libigl", None

    def __init__(self):
        import importlib.metadata

        import igl

        self.igl, self.version = igl, importlib.metadata.version("libigl")

    def build(self, v, t):  # each call builds
        self.v, self.t = v.astype(float), t.astype(numpy.int64)

    def touches(self, p, radius):
        return numpy.sqrt(self.igl.point_mesh_squared_distance(p.astype(float), self.v, self.t)[0]) <= radius

    def nearest(self, p):
        return self.igl.point_mesh_squared_distance(p.astype(float), self.v, self.t)[1]

    def inside(self, p):
        pseudonormal = self.igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL
        return self.igl.signed_distance(p.astype(float), self.v, self.t, sign_type=pseudonormal)[0] < 0


class Fcpw:
    name, most = "FCPW", None

    def __init__(self):
        import importlib.metadata

        import fcpw

        self.fcpw, self.version = fcpw, importlib.metadata.version("fcpw")

    def build(self, v, t):
        self.scene = self.fcpw.scene_3D()
        self.scene.set_object_count(1)
        self.scene.set_object_vertices(numpy.asfortranarray(v), 0)
        self.scene.set_object_triangles(numpy.asfortranarray(t.astype(numpy.int32)), 0)
        self.scene.build(self.fcpw.aggregate_type.bvh_surface_area, True)

    def _closest(self, p):
        found = self.fcpw.interaction_3D_list()
        far = numpy.full(len(p), numpy.inf, numpy.float32)
        self.scene.find_closest_points(numpy.asfortranarray(p), far, found)
        return found

    def touches(self, p, radius):
        return self._closest(p), lambda found: numpy.array([i.d for i in found]) <= radius

    def nearest(self, p):
        return self._closest(p), lambda found: numpy.array([i.primitive_index for i in found])


def libraries():
    yield Collide()
    for kind in (Open3d, Trimesh, Libigl, Fcpw):
        try:
            yield kind()
        except ImportError as reason:
            print(f"skipped: {kind.name} ({reason})")


def wrong_flags(points, radius, corners, nearest, mine, theirs):
    """How many of either are on the wrong side."""
    wrong = [0, 0]
    for i in numpy.flatnonzero(mine != theirs):
        truth = squared_distances(points[i], corners[nearest[i : i + 1]])[0] <= fractions.Fraction(float(radius)) ** 2
        wrong[0] += truth != mine[i]
        wrong[1] += truth != theirs[i]
    return wrong


def wrong_triangles(points, corners, mine, theirs):
    """How many of either are farther away than the other's."""
    wrong, differ = [0, 0], numpy.flatnonzero(mine != theirs)
    for i in differ:
        here, there = squared_distances(points[i], corners[[mine[i], theirs[i]]])
        wrong[0] += here > there
        wrong[1] += there > here
    return wrong


def is_inside(point, corners):
    """By a ray along +x, with rational numbers. Of a ray that meets an edge, and of a point on the surface, None."""
    y, z = point[1:]
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = corners[(low[:, 1] <= y) & (high[:, 1] >= y) & (low[:, 2] <= z) & (high[:, 2] >= z) & (high[:, 0] >= point[0])]
    px, py, pz = (fractions.Fraction(float(u)) for u in point)
    crossings = 0
    for a, b, c in near:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = ([fractions.Fraction(float(u)) for u in corner] for corner in (a, b, c))
        of = [(y1 - py) * (z2 - pz) - (z1 - pz) * (y2 - py) for y1, z1, y2, z2 in
              ((by, bz, cy, cz), (cy, cz, ay, az), (ay, az, by, bz))]
        if min(of) < 0 < max(of):
            continue
        if 0 in of:
            return None
        x = (of[0] * ax + of[1] * bx + of[2] * cx) / sum(of)
        if x == px:
            return None
        crossings += x > px
    return crossings % 2 == 1


def points_next_to(v, t, n):
    """Points on triangles, rounded."""
    random = numpy.random.default_rng(1)
    weights = random.dirichlet((1, 1, 1), n)
    corners = v[t[random.integers(0, len(t), n)].astype(int)].astype(float)
    return (weights[:, :, None] * corners).sum(axis=1).astype(numpy.float32)


def wrong_sides(points, corners, mine, theirs):
    """How many of either are on the wrong side, of those that are not on the surface."""
    wrong = [0, 0]
    for i in numpy.flatnonzero(mine != theirs):
        truth = is_inside(points[i], corners)
        wrong[0] += truth is not None and truth != mine[i]
        wrong[1] += truth is not None and truth != theirs[i]
    return wrong


def measure(scene, s, row):
    corners = s.vertices[s.triangles.astype(int)]
    beside = points_next_to(s.vertices, s.triangles, MOST)
    ours = Collide()
    ours.build(s.vertices, s.triangles)
    expected = dict(any=ours.touches(s.centres, s.radius), nearest=ours.nearest(s.centres), inside=ours.inside(beside))
    for one in libraries():
        build, _ = least(lambda: one.build(s.vertices, s.triangles), 1)
        points, repetitions = s.centres[: one.most], 3 if one.most is None else 1
        calls = dict(any=lambda: one.touches(points, s.radius), nearest=lambda: one.nearest(points))
        if scene == CLOSED and hasattr(one, "inside"):
            calls["inside"] = lambda: one.inside(points)
        for call, ask in calls.items():
            ms, found = least(ask, repetitions)
            if isinstance(found, tuple):  # what makes an array of a list of objects is not measured
                found = found[1](found[0])
            n, mine = len(points), expected[call][: len(points)]
            if call == "any":
                wrong = wrong_flags(points, s.radius, corners, expected["nearest"], mine, found)
            elif call == "nearest":
                n = min(MOST, n)
                wrong = wrong_triangles(points[:n], corners, mine[:n], found[:n])
            else:
                n = MOST
                wrong = wrong_sides(beside, corners, expected[call], one.inside(beside))
            row(scene, call, one.name, points=len(points), build_ms=build, query_ms=ms, checked=n, wrong=int(wrong[1]),
                wrong_of_collide=int(wrong[0]))


def overhead(row, reference):
    """A call with one sphere and one triangle, here and in C++: the difference is what Python adds."""
    lines = subprocess.run([reference, "one"], check=False, capture_output=True, text=True).stdout.splitlines()
    in_cpp = {name: float(us) for name, us in map(str.split, lines)}
    mesh = collide.Mesh(numpy.eye(3, dtype=numpy.float32))
    centre = numpy.zeros((1, 3), numpy.float32)
    calls = {name: lambda name=name: getattr(mesh, name)(centre, 1.0) for name in ("any", "count", "query", "contacts")}
    calls |= {name: lambda name=name: getattr(mesh, name)(centre) for name in ("nearest", "contains", "signed_distance")}
    for name, call in calls.items():
        times = []
        for _ in range(20):
            begin = time.process_time()
            for _ in range(500):
                call()
            times.append((time.process_time() - begin) / 500 * 1e6)
        row("one sphere", name, "collide", us=min(times), us_in_cpp=in_cpp[name])


def main():
    reference, out = sys.argv[1], pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    scenes = sys.argv[3:] or SCENES
    rows = []

    def row(scene, call, library, **numbers):
        rows.append({"name": f"python/{scene}/{call}/{library}", **numbers})
        print("  ".join(f"{k} {v:.4g}" if isinstance(v, float) else f"{v}" for k, v in rows[-1].items()), flush=True)

    overhead(row, reference)
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            spheres, triangles = SCENES[scene]
            path = pathlib.Path(folder) / scene
            subprocess.run([reference, scene, str(spheres), str(triangles), path], check=True)
            measure(scene, read_scene(path).of(numpy.float32), row)
    if out is not None:
        versions = {one.name: one.version for one in libraries() if hasattr(one, "version")}
        root = pathlib.Path(__file__).parents[2]
        commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=root, capture_output=True, text=True).stdout.strip()
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        model = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.machine())
        date = datetime.date.today().isoformat()
        context = dict(date=date, commit=commit, processor=model, python=platform.python_version(), versions=versions)
        out.write_text(json.dumps(dict(context=context, benchmarks=rows), indent=1) + "\n")


if __name__ == "__main__":
    main()
