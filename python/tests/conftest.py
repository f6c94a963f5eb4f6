"""What the tests share: scenes, and the answers of C++ to them."""

import os
import subprocess

import numpy
import pytest

SCENES = [  # of examples/io/scenes.hpp: the thirteen that libraries are compared on, and those that are hard
    "study", "few", "hits", "many_hits", "radii_1000", "radii_100", "many_triangles", "drum", "camera", "grains", "soup",
    "crowd", "sparse", "radii", "ball", "terrain", "slivers", "long_slivers", "giant", "clusters", "pile", "cube",
    "octahedron",
]


@pytest.fixture(scope="session")
def reference():
    """The program reference.cpp."""
    path = os.environ.get("COLLIDE_PYTHON_REFERENCE", "")
    if not path:
        pytest.skip("COLLIDE_PYTHON_REFERENCE does not name the program that C++ answers with")
    return path


class Scene:
    """Arrays of a scene, and what C++ says of it."""

    def __init__(self, vertices, triangles, centres, radius):
        self.vertices, self.triangles, self.centres, self.radius = vertices, triangles, centres, radius

    def of(self, dtype):
        radius = self.radius.astype(dtype) if isinstance(self.radius, numpy.ndarray) else float(dtype(self.radius))
        return Scene(self.vertices.astype(dtype), self.triangles, self.centres.astype(dtype), radius)

    def answers(self, reference, folder, displacements=None, precision=0, steps=0):
        """Bytes of all results, in the order of reference.cpp."""
        each = isinstance(self.radius, numpy.ndarray)
        dtype = self.vertices.dtype
        radius = self.radius if each else numpy.array([self.radius], dtype)
        numbers = [dtype.itemsize, len(self.vertices), len(self.triangles), len(self.centres), each]
        numbers += [displacements is not None, precision, steps]
        arrays = [numpy.array(numbers, numpy.uint64), self.vertices, self.triangles, self.centres, radius]
        with open(folder / "scene", "wb") as file:
            for array in arrays + ([displacements] if displacements is not None else []):
                file.write(array.tobytes())
        subprocess.run([reference, folder / "scene", folder / "results"], check=True)
        data, results = (folder / "results").read_bytes(), []
        while data:
            size = int.from_bytes(data[:8], "little")
            results.append(data[8 : 8 + size])
            data = data[8 + size :]
        return results


def read_scene(path):
    data = path.read_bytes()
    _, vertices, triangles, spheres, each, *_ = numpy.frombuffer(data, numpy.uint64, 8).astype(int)
    arrays, at = [], 64
    for n, dtype in ((3 * vertices, float), (3 * triangles, numpy.uint32), (3 * spheres, float), (spheres if each else 1, float)):
        arrays.append(numpy.frombuffer(data, dtype, n, at))
        at += arrays[-1].nbytes
    v, t, c, r = arrays
    return Scene(v.reshape(-1, 3), t.reshape(-1, 3), c.reshape(-1, 3), r if each else float(r[0]))


@pytest.fixture(scope="session")
def scene(reference, tmp_path_factory):
    """Makes a scene by its name, small."""
    made = {}

    def make(name):
        if name not in made:
            path = tmp_path_factory.mktemp("scene") / name
            subprocess.run([reference, name, "4000", "1000", path], check=True)
            made[name] = read_scene(path)
        return made[name]

    return make
