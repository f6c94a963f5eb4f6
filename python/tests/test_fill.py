"""Regions full of spheres: in the region, without overlaps, of the sizes that were asked for, and by a seed."""

import numpy
import pytest

import collide

CUBE = numpy.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
SIDES = numpy.array([  # that turn outwards
    [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
])
LOWER, UPPER = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


def largest_overlap(found):
    apart = numpy.linalg.norm(found.centres[:, None] - found.centres[None], axis=2)
    apart[numpy.arange(len(apart)), numpy.arange(len(apart))] = numpy.inf
    return (found.radii[:, None] + found.radii[None] - apart).max()


@pytest.mark.parametrize("region", [(LOWER, UPPER), CUBE[SIDES], ((0.5, 0.5, 0), (0.5, 0.5, 1), 0.5)])
def test_spheres_are_inside_and_do_not_overlap(region):
    found = collide.fill(region, ("uniform", 0.05, 0.08), 0.3, seed=1)
    volume = numpy.pi / 4 if len(region) == 3 else 1
    assert found.centres.shape == (len(found.radii), 3) and len(found.radii) > 100
    assert found.radii.min() >= 0.05 and found.radii.max() <= 0.08
    assert abs(4 / 3 * numpy.pi * (found.radii**3).sum() / volume - found.fraction) < 1e-12
    assert abs(found.fraction - 0.3) < 0.01
    assert largest_overlap(found) < 1e-9
    assert (found.centres - found.radii[:, None] > -1e-9).all() and (found.centres + found.radii[:, None] < 1 + 1e-9).all()
    again = collide.fill(region, ("uniform", 0.05, 0.08), 0.3, seed=1)
    assert (again.centres == found.centres).all() and (again.radii == found.radii).all()


def test_a_number_of_spheres_of_a_sieve_curve():
    found = collide.fill((LOWER, UPPER), ("sieve", [0.08, 0.1, 0.14], [0, 0.5, 1]), number=120)
    assert len(found.radii) == 120 and largest_overlap(found) < 1e-9
    assert 0.04 <= found.radii.min() and found.radii.max() <= 0.07
    assert (collide.fill((LOWER, UPPER), 0.05, number=7).radii == 0.05).all()
    for name, numbers in (("normal", (0.05, 0.01, 0.03, 0.07)), ("lognormal", (0.05, 0.2, 0.03, 0.07))):
        radii = collide.fill((LOWER, UPPER), (name, *numbers), number=100).radii
        assert 0.03 <= radii.min() < 0.05 < radii.max() <= 0.07


@pytest.mark.parametrize("arguments, named, error, why", [
    (((LOWER, UPPER), 0.05), {}, ValueError, "fraction: give it, or a number"),
    (((LOWER, UPPER), 0.05, 0.1), {"number": 3}, ValueError, "fraction: give it, or a number"),
    (((LOWER, UPPER), 0.05), {"number": 0}, ValueError, "number: is 0"),
    (((LOWER, UPPER), "uniform", 0.1), {}, TypeError, "sizes: expected a number"),
    (((LOWER, UPPER), ("uniform", 1), 0.1), {}, ValueError, "sizes: uniform has 2 numbers"),
    (((LOWER, UPPER), ("sieve", [1, 2], [0]), 0.1), {}, ValueError, "sizes: a sieve curve has"),
    (((LOWER, UPPER), (), 0.1), {}, ValueError, "sizes: is None"),
    ((LOWER, 0.05, 0.1), {}, ValueError, "region: expected"),
    (((LOWER, UPPER), 0.05, 0.9), {}, collide.Error, "room"),
    (((UPPER, LOWER), 0.05, 0.3), {}, collide.Error, "fill"),
    ((CUBE[SIDES[:, ::-1]], 0.05, 0.3), {}, collide.Error, "outwards"),
    (((LOWER, UPPER), -1, 0.3), {}, collide.Error, "radi"),
])
def test_errors_name_the_argument(arguments, named, error, why):
    with pytest.raises(error, match=why):
        collide.fill(*arguments, **named)
