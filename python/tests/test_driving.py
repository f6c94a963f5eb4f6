"""What a simulation is asked, and told, between steps: driven bodies, contacts, births, progress."""

import numpy
import pytest

import collide
from test_simulation import FALL, SQUARE, TRIANGLES, cache, compiles, falling, floor  # noqa: F401: a fixture

RADIUS = 0.1


def paddle():
    """A wall across x = 0, from y = 0 to 1."""
    wall = numpy.array([[0, 0, -1], [0, 1, -1], [0, 1, 1], [0, 0, 1]], float)
    return collide.Mesh(wall, TRIANGLES)


def pushed(bodies=(collide.Body(0, 2),), **options):
    sim = collide.Simulation(paddle(), [collide.driven_bodies(), collide.bounce(0)], bodies=bodies, **options)
    sim.set(numpy.array([[0.2, 0.5, 0]]), RADIUS)
    return sim


@compiles
def test_a_body_is_where_it_is_driven():
    """A wall that is pushed at a grain takes it along; one that stops no longer does."""
    sim = pushed()
    for k in range(100):
        sim.drive(0, shift=(0.01 * (k + 1), 0, 0), velocity=(1, 0, 0))
        sim.step(0.01)
    assert abs(sim["position"][0, 0] - (1 + RADIUS)) < 0.02 and abs(sim["velocity"][0, 0] - 1) < 1e-6
    sim.drive(0, shift=(1, 0, 0))
    sim.steps(10, 0.01)
    assert abs(sim["position"][0, 0] - (1.1 + RADIUS)) < 0.02


@compiles
def test_driving_is_what_a_body_that_moves_by_itself_does():
    """Turned around a pivot and an axis that is no unit vector, and shifted: as the family of motions."""
    motion = dict(pivot=(0.25, -0.5, 0), axis=(0, 0, 2))
    driven = pushed([collide.Body(0, 2, **motion)])
    own = collide.Simulation(
        paddle(), [collide.moving_bodies(), collide.bounce(0)], bodies=[collide.Body(0, 2, rate=-0.5, velocity=(0.25, 0, 0), **motion)]
    )
    own.set(numpy.array([[0.2, 0.5, 0]]), RADIUS)
    for k in range(1, 151):
        driven.drive(0, angle=-0.005 * k, rate=-0.5, shift=(0.0025 * k, 0, 0), velocity=(0.25, 0, 0))
        driven.step(0.01)
    own.steps(150, 0.01)
    assert own["position"][0, 0] > 0.3
    assert numpy.allclose(driven["position"], own["position"], atol=1e-9)


@compiles
def test_a_servo_does_not_jump_where_its_rate_changes():
    sim, angle = pushed([collide.Body(0, 2, axis=(0, 0, 1))]), 0.0
    for k in range(200):
        rate = -0.5 if k < 100 else -0.1
        angle += rate * 0.01
        sim.drive(0, angle, rate)
        sim.step(0.01)
        assert numpy.linalg.norm(sim["velocity"][0]) < 1


@compiles
def test_wrong_drives():
    sim = pushed()
    for arguments, error, text in (
        (dict(body=1), ValueError, "body: is 1"), (dict(body=0, angle="a"), TypeError, "angle: expected a number"),
        (dict(body=0, shift=(1, 2)), ValueError, "shift: expected 3 numbers"),
    ):
        with pytest.raises(error, match=text):
            sim.drive(**arguments)
    with pytest.raises(ValueError, match="body: the simulation has none"):
        falling().drive(0)


def test_contacts_are_those_of_all_pairs():
    centres = numpy.random.default_rng(0).uniform(-1, 1, (400, 3))
    sim = collide.Simulation(collide.Mesh(SQUARE, TRIANGLES), [collide.gravity(), collide.sphere_contact()])
    sim.set(centres.astype(numpy.float32), 0.125)
    x = sim["position"].astype(float)
    apart = ((x[:, None] - x[None]) ** 2).sum(-1)
    expected = numpy.argwhere(numpy.triu(apart <= 0.25**2, 1))
    found = sim.contacts()
    assert found.dtype == numpy.int32 and len(expected) > 100 and numpy.array_equal(found, expected)
    report = sim.contact_report()
    deepest = 0.25 - numpy.sqrt(apart[tuple(expected.T)].min())
    assert report.contacts == len(expected) and abs(report.coordination - len(expected) / 200) < 1e-12
    assert abs(report.largest_overlap - deepest / 0.125) < 1e-5 and 0 < sim.largest_time_step() < 1
    assert falling().contacts().shape == (0, 2) and falling().contact_report().contacts == 0


@compiles
def test_births():
    sim = collide.Simulation(floor(), [collide.emit(100, (0, 0, 1), half_width=0.5), collide.gravity()])
    sim.set(numpy.zeros((0, 3), numpy.float32), 0.4, capacity=100)
    sim.steps(50, 0.01)
    assert sim.births.due in (49, 50) and sim.births.not_born == 0 and len(sim.contacts()) > 0
    there = numpy.flatnonzero(sim["alive"])
    assert len(there) == sim.births.due and numpy.isin(sim.contacts(), there).all()
    with pytest.raises(ValueError, match="births: no effect of the list makes particles"):
        falling().births


def test_progress():
    sim, seen = falling(), []
    sim.steps(10, 1e-3, call=seen.append, every=4)
    assert seen == [4, 8, 10]
    sim.steps(1000, 1e-3, call=seen.append)
    assert seen[3:] == list(range(10, 1001, 10)) and abs(sim.time - 1.01) < 1e-4
    times = []
    sim.steps(3, 1e-3, call=lambda done: times.append(sim.time), every=1)
    assert numpy.allclose(numpy.diff(times), 1e-3, atol=1e-6)
    with pytest.raises(ZeroDivisionError):
        sim.steps(10, 1e-3, call=lambda done: 1 / 0, every=5)
    assert abs(sim.time - 1.018) < 1e-4
    with pytest.raises(TypeError, match="call: expected a function"):
        sim.steps(10, 1e-3, call=5)
    with pytest.raises(ValueError, match="every: is for a function"):
        sim.steps(10, 1e-3, every=5)


def test_effects_and_bodies_from_any_iterable_and_lists_of_numbers():
    sim = collide.Simulation(floor(), (effect for effect in FALL), bodies=iter(()))
    sim.set([[0, 0, 2], [1, 0, 3]], 0.25, [[0, 0, 0], [0, 0, 1]])
    assert "position" in sim and "radius" not in sim and sim["velocity"][1, 2] == 1
    assert collide.Body(0, 2, pivot=[1, 2, 3])._numbers()[2:5] == [1, 2, 3]


@compiles
def test_a_wrong_order_is_an_error_in_a_sentence():
    with pytest.raises(collide.Error, match=r"^collide: the effects gravity, friction, bounce: an effect comes after those whose result it uses[^\n]*$"):
        collide.Simulation(floor(), [collide.gravity(), collide.friction(), collide.bounce()])
