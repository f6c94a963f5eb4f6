"""What is in the wheel, and what it needs."""

import glob
import os
import pathlib
import shutil
import subprocess
import sys

import numpy
import pytest

import collide
from collide import _arrays

EXPECTED = {
    "minimal.py": "sphere 0 touches triangle 0",
    "first_simulation.py": "after 5 s the centres are 0.25 and 0.25 m high",
    "own_effect.py": "after a period it is at 1.000",
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
        assert needed <= {"libc", "libm", "libgcc_s", "libstdc++", "libgomp"}, path
        assert all("libgomp" not in line or str(HERE) in line for line in lines), path


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


def test_headers_and_types_are_there():
    for name in ("include/collide/bucket.cuh", "include/Eigen/Core", "src/simulation_of.hpp", "py.typed"):
        assert (HERE / name).exists()


@pytest.mark.parametrize("name", EXPECTED)
def test_examples(name):
    path = pathlib.Path(__file__).parents[2] / "examples" / "python" / name
    if not path.exists():
        pytest.skip("the examples are not here")
    if name in ("own_effect.py", "granular.py") and not shutil.which("g++"):
        pytest.skip("there is no g++ here")
    done = subprocess.run([sys.executable, path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [EXPECTED[name]]
