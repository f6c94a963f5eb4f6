"""All outputs on all scenes have the bytes that C++ gives."""

import numpy
import pytest

import collide
from conftest import SCENES


def bytes_of(mesh, centres, radius, **options):
    """In the order of reference.cpp, before the last one or two."""
    pairs = mesh.query(centres, radius, order="canonical", **options)
    rows = mesh.query(centres, radius, order="canonical", output="csr", **options)
    contacts = mesh.contacts(centres, radius, order="canonical", **options)
    results = [numpy.uint64(mesh.count(centres, radius, **options)), mesh.any(centres, radius, **options)]
    return [array.tobytes() for array in (*results, pairs.records, *rows, contacts.records)]


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.float64])
@pytest.mark.parametrize("name", SCENES)
def test_spheres_at_rest(name, dtype, scene, reference, tmp_path):
    s = scene(name).of(dtype)
    mesh = collide.Mesh(s.vertices, s.triangles)
    expected = s.answers(reference, tmp_path)
    found = bytes_of(mesh, s.centres, s.radius)
    found.append(mesh.contacts(s.centres, s.radius, closest=True).records.tobytes())
    assert found == expected[:-4]
    near = [mesh.nearest(s.centres), mesh.k_nearest(s.centres, 3), mesh.signed_distance(s.centres)]
    for mine, theirs in zip(near, expected[-4:-1]):
        theirs = numpy.frombuffer(theirs, numpy.int32).reshape(mine.records.shape)
        for word in range(theirs.shape[-1]):
            if dtype == numpy.float32 or word != 17:  # which is padding
                assert (mine.records[..., word] == theirs[..., word]).all()
    assert mesh.contains(s.centres).tobytes() == expected[-1]


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.float64])
@pytest.mark.parametrize("name", ["study", "drum", "soup", "radii", "cube"])
def test_moving_spheres(name, dtype, scene, reference, tmp_path):
    s = scene(name).of(dtype)
    size = numpy.ptp(s.vertices, axis=0).max() / 20
    displacements = (numpy.random.default_rng(1).normal(size=s.centres.shape) * size).astype(dtype)
    mesh = collide.Mesh(s.vertices, s.triangles)
    expected = s.answers(reference, tmp_path, displacements)
    found = bytes_of(mesh, s.centres, s.radius, displacements=displacements)
    found.append(mesh.impacts(s.centres, displacements, s.radius, order="canonical").records.tobytes())
    found.append(mesh.impacts(s.centres, displacements, s.radius, first=True).records.tobytes())
    assert found == expected


@pytest.mark.parametrize("number, precision", [(1, "double"), (2, "single")])
@pytest.mark.parametrize("name", ["study", "long_slivers"])
def test_precisions(name, number, precision, scene, reference, tmp_path):
    s = scene(name).of(numpy.float32)
    expected = s.answers(reference, tmp_path, precision=number)
    assert bytes_of(collide.Mesh(s.vertices, s.triangles), s.centres, s.radius, precision=precision) == expected[:-1]


def test_steps(scene, reference, tmp_path):
    s = scene("terrain").of(numpy.float32)
    expected = s.answers(reference, tmp_path, steps=200)
    sim = collide.Simulation(collide.Mesh(s.vertices, s.triangles), [collide.gravity(0, 0, -9.81), collide.bounce(0.5)])
    sim.set(s.centres, s.radius)
    sim.steps(200, 1e-3)
    assert [sim["position"].tobytes(), sim["velocity"].tobytes()] == expected[-2:]
