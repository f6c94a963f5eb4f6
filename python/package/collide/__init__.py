"""Collision detection between a triangle mesh and very many spheres: exact, on CPUs and NVIDIA GPUs.

    import collide, numpy
    mesh = collide.Mesh(vertices, triangles)          # float32 or float64; where they lie, it runs
    pairs = mesh.query(centres, radius)               # pairs.sphere, pairs.triangle
    touched = mesh.any(centres, radius)
    distance = mesh.signed_distance(points).distance

Arrays are those of numpy, PyTorch, CuPy, JAX or Warp, or of anything with ``__dlpack__``, of any strides that are not
negative along the rows; short lists are taken, too. No array is converted or copied: a wrong dtype, shape or device is an error that names the
argument. Results are arrays of the library that the call's centres are of, on the same device. Lengths are in any unit,
the same for all arguments. `Mesh` has the queries, `Simulation` particles that move.
"""

from . import _host
from ._clumps import ClumpShape, random_rotations
from ._errors import Error
from ._fill import Filling, fill
from ._mesh import Contacts, Csr, Impacts, Mesh, Nearest, Pairs, Seams, SignedDistance, Surface, Winding
from ._simulation import Births, Body, ContactReport, Flow, Impulses, Loads, Simulation
from . import effects, granular
from .effects import *  # noqa: F403: collide.gravity() and all the others
from .effects import Effect, Law
from .granular import granular_contact

__version__: str = ".".join(map(str, _host.version))

__all__ = [
    "Births", "Body", "ClumpShape", "ContactReport", "Contacts", "Csr", "Effect", "Error", "Filling", "Flow", "Impacts", "Impulses", "Law",
    "Loads", "Mesh", "Nearest", "Pairs", "Seams", "SignedDistance", "Simulation", "Surface", "Winding", "effects", "granular",
    "fill", "granular_contact", "random_rotations",
]
__all__ += effects.__all__
