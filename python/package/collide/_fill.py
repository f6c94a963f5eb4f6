"""Regions full of spheres."""

from typing import Any, NamedTuple

import numpy

from . import _host
from ._arrays import numbers
from ._errors import choice, real, refuse, whole

_NUMBERS = {"uniform": 2, "normal": 4, "lognormal": 4}
Sizes = float | tuple[Any, ...]


class Filling(NamedTuple):
    """Spheres in a region, on the host."""

    centres: numpy.ndarray  #: (n, 3) float64
    radii: numpy.ndarray  #: (n,)
    fraction: float  #: of the region's volume that they take


def fill(region: Any, sizes: Sizes, fraction: float | None = None, *, number: int | None = None, seed: int = 0) -> Filling:
    """Spheres that do not overlap, in a region: up to a ``fraction`` of its volume, or a ``number`` of them. They drop, and
    roll until three others hold them.

    region  a box, ``(lower, upper)``; a cylinder, ``(centre of one end, of the other, radius)``; or the inside of a closed
            mesh, (m, 3, 3) numbers, the corners of its triangles: ``vertices[triangles]``
    sizes   a radius; or ``("uniform", smallest, largest)``, ``("normal", mean, deviation, smallest, largest)``,
            ``("lognormal", median, deviation of logarithms, smallest, largest)``, ``("sieve", openings, parts of the mass)``
    seed    0 to 2^24 - 1: the same spheres for the same one

    Raises `collide.Error` if there is not so much room. O(n).
    """
    refuse((fraction is None) == (number is None), "fraction", "give it, or a number")
    count = 0 if number is None else whole("number", number, 1)
    part = 0.0 if fraction is None else real("fraction", fraction)
    name, numbers = _distribution(sizes)
    of_region = _region(region)
    memory, taken = _host.fill(of_region, name, numbers, part, count, whole("seed", seed, 0, 2**24 - 1))
    found = numpy.frombuffer(memory).copy()
    n = len(found) // 4
    return Filling(found[: 3 * n].reshape(n, 3), found[3 * n :], taken)


def _flat(name, values):
    return numbers(name, values).ravel().tolist()


def _distribution(sizes):
    if not isinstance(sizes, (tuple, list)):
        radius = real("sizes", sizes)
        return "uniform", [radius, radius]
    name = choice("sizes", sizes[0] if len(sizes) > 0 else None, (*_NUMBERS, "sieve"))
    numbers = [_flat("sizes", values) for values in sizes[1:]]
    if name == "sieve":
        refuse(len(numbers) != 2 or len(numbers[0]) != len(numbers[1]), "sizes", "a sieve curve has as many openings as parts")
    refuse(name != "sieve" and list(map(len, numbers)) != [1] * _NUMBERS[name], "sizes", f"{name} has {_NUMBERS.get(name)} numbers")
    return name, sum(numbers, [])


def _region(region):
    of_box = isinstance(region, (tuple, list)) and len(region) in (2, 3)
    parts = [_flat("region", part) for part in region] if of_box else []
    if [len(part) for part in parts] in ([3, 3], [3, 3, 1]):
        return sum(parts, [])
    expected = "(lower, upper), (end, other end, radius), or (m, 3, 3) numbers"
    corners = numbers("region", region, expected)
    refuse(corners.ndim != 3 or corners.shape[1:] != (3, 3), "region", f"expected {expected}")
    return corners.ravel().tolist()
