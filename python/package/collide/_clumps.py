"""Grains that are rigid groups of spheres."""

from typing import Any

import numpy

from . import _host
from ._arrays import table
from ._errors import whole


class ClumpShape:
    """Spheres that move as one, of one density, for `Simulation.set_clumps`.

    centres  (n, 3) numbers, in any frame; spheres may overlap
    radii    a number, or one of each sphere, above 0

    `volume` and `inertia`, the principal moments over the mass, are those of the union, to 1e-6 where spheres overlap;
    `centre` is its centre of mass, and `reach` the largest distance of a sphere's surface from it.
    """

    def __init__(self, centres: Any, radii: Any) -> None:
        x = table("centres", centres, "n", 3)
        r = table("radii", radii, len(x), 1)
        self._count = len(x)
        found = numpy.array(_host.shape_of_clump(numpy.hstack([x, r]).ravel().tolist()))
        self.volume, self.inertia, self.centre = float(found[0]), found[1:4], found[-3:]
        self._numbers = [float(self._count), *found[:-3].tolist()]
        self.reach = float((numpy.linalg.norm(x - self.centre, axis=1) + r[:, 0]).max())

    def __repr__(self):
        return f"<collide.ClumpShape: {self._count} spheres, volume {self.volume:.6g}>"


def random_rotations(number: int, seed: int = 0) -> numpy.ndarray:
    """(number, 4): rotations as unit quaternions w, x, y, z, at random, all equally likely; ``seed`` from 0 to 2^24 - 1."""
    found = _host.random_rotations(whole("number", number), whole("seed", seed, 0, 2**24 - 1))
    return numpy.array(found).reshape(-1, 4)

