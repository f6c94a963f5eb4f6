"""Clumps: their shapes, where they are put, how they move, and how they are read."""

import copy

import numpy
import pytest

import collide
from collide import granular
from test_simulation import SQUARE, TRIANGLES, cache, compiles  # noqa: F401: a fixture

DUMBBELL = collide.ClumpShape([[0, 0, 0], [0.5, 0, 0]], 0.1)


def scene(*more, gravity=-9.81, restitution=0.5):
    materials = granular.materials(granular.Solid(1e6, 0.25, 1000), granular.SurfacePair(restitution, 0.5))
    law = collide.granular_contact(granular.hertz(), granular.mindlin(), materials=materials)
    floor = collide.Mesh(SQUARE.astype(float), TRIANGLES)
    return collide.Simulation(floor, [collide.gravity(z=gravity), law, collide.clumps(), *more, collide.velocity_verlet()])


def turned(q, x):
    w, v, x = q[0], numpy.asarray(q[1:]), numpy.asarray(x)
    return x + 2 * numpy.cross(v, numpy.cross(v, x) + w * x)


def test_a_shape_has_the_moments_of_closed_forms():
    assert DUMBBELL.volume == pytest.approx(2 * 4 / 3 * numpy.pi * 0.1**3, rel=1e-14)
    assert sorted(DUMBBELL.inertia) == pytest.approx([0.004, 0.0665, 0.0665], rel=1e-12)
    assert DUMBBELL.centre == pytest.approx([0.25, 0, 0]) and DUMBBELL.reach == pytest.approx(0.35)
    lens = collide.ClumpShape([[0, 0, 0], [0.1, 0, 0]], [0.1, 0.1]).volume / (4 / 3 * numpy.pi * 0.1**3)
    assert lens == pytest.approx(2 - 5 / 16, rel=1e-6)
    q = collide.random_rotations(1000, 3)
    assert numpy.linalg.norm(q, axis=1) == pytest.approx(numpy.ones(1000)) and abs(q.mean(axis=0)).max() < 0.05
    assert (collide.random_rotations(3, 3) == q[:3]).all()


@compiles
def test_clumps_fall_turn_and_are_read():
    sim = scene()
    q = collide.random_rotations(2, 1)
    sim.set_clumps(DUMBBELL, [[0, 0, 4], [3, 0, 5]], q, angular_velocities=[0, 0, 2])
    assert sim["clump_rotation"].shape == (4, 4) and sim["in_clump"].tolist() == [0, 0, 2, 2]
    for k, end in enumerate([[-0.25, 0, 0], [0.25, 0, 0]]):
        assert sim["position"][k] == pytest.approx(turned(q[0], end) + [0, 0, 4], abs=1e-14)
    sim.steps(500, 1e-3)
    assert sim["clump_centre"][0] == pytest.approx([0, 0, 4 - 9.81 / 8], abs=1e-12)
    assert numpy.linalg.norm(sim["clump_rotation"][2]) == pytest.approx(1, abs=1e-14)
    apart = numpy.linalg.norm(sim["position"][0] - sim["position"][1])
    assert apart == pytest.approx(0.5, abs=1e-13)
    assert sim.energy()["kinetic"] == pytest.approx(2 * 1000 * DUMBBELL.volume * (9.81 / 2) ** 2 / 2)
    sim.steps(4000, 1e-3)
    lowest = sim["position"].reshape(2, 2, 3)[:, :, 2].min(axis=1)
    assert lowest == pytest.approx([0.1, 0.1], abs=4e-3)  # they lie on the floor, and press it
    again = copy.deepcopy(sim)
    again.steps(10, 1e-3), sim.steps(10, 1e-3)
    assert (again["position"] == sim["position"]).all()


@compiles
def test_a_filling_becomes_clumps_of_several_shapes():
    filled = collide.fill(((-1, -1, 1), (1, 1, 3)), ("uniform", 0.2, 0.3), number=30)
    one = collide.ClumpShape([[0, 0, 0]], 0.2)
    shape = numpy.arange(30) % 2
    reach = numpy.where(shape == 0, DUMBBELL.reach, one.reach)
    sim = scene(collide.polydisperse())
    sim.set_clumps([DUMBBELL, one], filled.centres, collide.random_rotations(30), shape=shape, scale=filled.radii / reach)
    assert len(sim) == 45 and (sim["in_clump"] == -1).sum() == 15
    assert sim.contact_report().contacts == 0
    x = sim["position"][sim["in_clump"] == -1]
    assert x == pytest.approx(filled.centres[1::2], abs=1e-14)


@compiles
def test_clumps_wait_for_a_source():
    sim = scene(collide.emit(20, (0, 0, 4)))
    sim.set_clumps(DUMBBELL, [[0, 0, 4]] * 11, waiting=10)
    assert sim["alive"].tolist() == [1, 1] + 20 * [0]
    sim.steps(400, 1e-3)
    assert sim["alive"].sum() == 2 * (1 + 8) and sim.births.due == 8


@compiles
def test_errors_name_the_argument():
    sim = scene()
    for arguments, named, error, why in [
        ((DUMBBELL, [[0, 0]]), {}, ValueError, "centres: has shape"),
        ((DUMBBELL, [[0, 0, 0]], [[1, 0, 0, 0]] * 2), {}, ValueError, "rotations: has shape"),
        ((DUMBBELL, [[0, 0, 0]]), {"shape": 1}, ValueError, "shape: expected"),
        (("text", [[0, 0, 0]]), {}, TypeError, "shapes: expected"),
        ((DUMBBELL, [[0, 0, 0]], (2, 0, 0, 0)), {}, collide.Error, "quaternion"),
        ((DUMBBELL, [[0, 0, 0]]), {"scale": [0]}, collide.Error, "scale"),
        ((DUMBBELL, "text"), {}, TypeError, "centres: expected numbers"),
    ]:
        with pytest.raises(error, match=why):
            sim.set_clumps(*arguments, **named)
    sim.set_clumps(DUMBBELL, [[0, 0, 4]])
    with pytest.raises(collide.Error, match="set_clumps"):
        sim["position"] = numpy.zeros((2, 3))
    with pytest.raises(collide.Error, match="radii are above 0"):
        collide.ClumpShape([[0, 0, 0]], 0)
    floor = collide.Mesh(SQUARE.astype(float), TRIANGLES)
    with pytest.raises(collide.Error, match="needs clumps"):
        collide.Simulation(floor, [collide.gravity()]).set_clumps(DUMBBELL, [[0, 0, 4]])
