"""What is in the wheel, and what it needs."""

import glob
import inspect
import os
import pathlib
import shutil
import subprocess
import sys
import textwrap
import zipfile

import numpy
import pytest

import collide
from collide import _arrays, _mesh

EXPECTED = {
    "minimal.py": "sphere 0 touches triangle 0",
    "first_simulation.py": "after 5 s the centres are 0.25 and 0.25 m high",
    "own_effect.py": "after a period it is at 1.000",
    "servo.py": "the paddle has turned by 0.20 rad, and pushes the ball at 0.27 m/s",
    "granular.py": "after 1.00 s the heap is 1.9 cm high",  # as granular.cpp
}
HERE = pathlib.Path(collide.__file__).parent


def test_the_wheel_is_small():
    wheels = glob.glob(os.environ.get("COLLIDE_WHEELS", "") + "/collide_spheres-*.whl")
    if not wheels:
        pytest.skip("COLLIDE_WHEELS does not name the folder of the wheel")
    assert os.path.getsize(wheels[0]) < 5e6


def test_modules_need_nothing_but_what_every_debian_has():
    """libc, libm, libgcc and libstdc++; OpenMP's library is in the wheel."""
    for path in [*HERE.glob("_host*.so"), *HERE.glob("lists/*.so")]:
        lines = subprocess.run(["ldd", path], capture_output=True, text=True, check=True).stdout.splitlines()
        needed = {line.split()[0].rpartition("/")[2].split(".so")[0] for line in lines if "=>" in line}
        assert needed <= {"libc", "libm", "libgcc_s", "libstdc++", "libgomp", "libcollide_python"}, path
        assert all("libgomp" not in line and "libcollide" not in line or str(HERE) in line for line in lines), path


def test_without_anything_else(tmp_path):
    """With nothing on the PATH, and nothing but numpy."""
    code = "import collide, numpy; m = collide.Mesh(numpy.eye(3, dtype='float32')); print(m.count(numpy.zeros((1, 3), 'float32'), 1))"
    env = {"PATH": str(tmp_path), "PYTHONPATH": os.environ.get("PYTHONPATH", "")}
    done = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("1\n", "")


class OnGpu:
    """An array that says that it is on a GPU, where there may be none."""

    dtype = "float32"

    def __dlpack_device__(self):
        return 2, 0

    def __dlpack__(self, **options):
        raise AssertionError("asked too early")


@pytest.mark.skipif(_arrays._cuda is not None and _arrays._cuda.device_count() > 0, reason="there is a GPU")
def test_without_a_gpu():
    """Arrays of the host work with either package, and one on a GPU is an error that says what is missing."""
    assert collide.Mesh(numpy.eye(3)).count(numpy.zeros((1, 3)), 1) == 1
    if _arrays._cuda is None:
        error, text = ValueError, "vertices: is on a GPU, which needs the package collide-spheres-cu13"
    else:
        error, text = collide.Error, "CUDA finds no GPU here, or no driver for CUDA"
    with pytest.raises(error, match=text):
        collide.Mesh(OnGpu())
    host = collide.Mesh(numpy.eye(3, dtype="float32"))
    with pytest.raises((ValueError, TypeError), match="centres: "):
        host.count(OnGpu(), 1)


def test_licences_of_all_that_is_inside():
    wheels = glob.glob(os.environ.get("COLLIDE_WHEELS", "") + "/collide_spheres-*.whl")
    if not wheels:
        pytest.skip("COLLIDE_WHEELS does not name the folder of the wheel")
    names = zipfile.ZipFile(wheels[0]).namelist()
    there = {name.rpartition("/")[2] for name in names if "/licenses/" in name}
    assert there == {"LICENSE", "eigen.txt", "libgomp.txt", "nanobind.txt", "robin_map.txt"}


@pytest.mark.parametrize("kind", [collide.Pairs, collide.Contacts, collide.Impacts, collide.Nearest, collide.SignedDistance, collide.Winding])
def test_fields_have_docstrings_whatever_the_indentation(kind):
    """Python 3.13 dedents docstrings when it compiles, as inspect.cleandoc does; -OO removes them."""
    fields = {name: value for name, value in vars(kind).items() if isinstance(value, _mesh._field)}
    assert fields
    old = textwrap.indent(inspect.cleandoc(kind.__doc__), "    ").strip()
    for doc in (old, inspect.cleandoc(old)):
        copy = type("Copy", (), {"__doc__": doc, **{name: _mesh._field(0) for name in fields}})
        for name, field in fields.items():
            assert field.__doc__ and vars(copy)[name].__doc__ == field.__doc__
    bare = type("Copy", (), {**{name: _mesh._field(0) for name in fields}})
    assert all(vars(bare)[name].__doc__ is None for name in fields)


def test_without_docstrings():
    code = "import collide; m = collide.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]]); print(m.nearest([[0, 0, 1]]).distance, collide.gravity(z=1))"
    done = subprocess.run([sys.executable, "-OO", "-c", code], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("[1.] collide.gravity(x=0.0, y=0.0, z=1.0)\n", "")


def test_headers_and_types_are_there():
    for name in ("include/collide/bucket.cuh", "include/Eigen/Core", "src/simulation_of.hpp", "py.typed"):
        assert (HERE / name).exists()


def test_the_example_in_jax():
    pytest.importorskip("jax")
    path = pathlib.Path(__file__).parents[2] / "examples" / "python" / "jax_distance.py"
    done = subprocess.run([sys.executable, path], capture_output=True, text=True)
    assert done.stdout.split("]")[0].split() == ["[", "1.", "-0.10000002"], done.stderr


@pytest.mark.parametrize("name", EXPECTED)
def test_examples(name):
    path = pathlib.Path(__file__).parents[2] / "examples" / "python" / name
    if not path.exists():
        pytest.skip("the examples are not here")
    if name in ("own_effect.py", "granular.py", "servo.py") and not shutil.which("g++"):
        pytest.skip("there is no g++ here")
    done = subprocess.run([sys.executable, path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [EXPECTED[name]]
