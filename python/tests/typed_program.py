"""A program that uses all of the package, for mypy --strict and pyright: test_types.py. It runs, too."""

from typing import Any, Tuple

import numpy

import collide
from collide import granular

vertices = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], numpy.float32)
triangles = numpy.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
points = numpy.full((2, 3), 0.1, numpy.float32)

mesh: collide.Mesh = collide.Mesh(vertices, triangles, bodies=[(0, 4)], validate=True, threads=1)
pose = [[0, 0, 0, 1, 0, 0, 0]]
pairs: collide.Pairs = mesh.query(points, 0.5, order="canonical", precision="double", capacity=100)
sphere, triangle = pairs
rows: collide.Csr = mesh.query(points, 0.5, output="csr")
total: int = pairs.total + mesh.count(points, 0.5) + len(mesh)
complete: bool = pairs.complete
flags: Any = mesh.any(points, 0.5, poses=pose)
touching: collide.Contacts = mesh.contacts(points, 0.5, closest=True)
hits: collide.Impacts = mesh.impacts(points, points, 0.1, first=True, poses=pose)
near: collide.Nearest = mesh.nearest(points, max_distance=2.0)
several: collide.Nearest = mesh.k_nearest(points, 2, poses=pose)
sides: collide.SignedDistance = mesh.signed_distance(points, poses=pose)
numbers: Any = (rows.offsets, touching.depth, hits.time, near.point, several.barycentric, sides.gradient)
inside: Any = mesh.contains(points) | (mesh.winding_number(points, beta=4).value > 0.5)
lengths: Any = mesh.distance(points, signed=True)
seams: collide.Seams = mesh.validate_closed()
surface: collide.Surface = mesh.validate_surface(1e-6)
closed: Tuple[bool, bool, str, str] = (mesh.is_closed, seams.is_oriented, seams.message, surface.message)
crossing: Any = mesh.self_intersections()
mesh.update(vertices, triangles)

materials = granular.materials(granular.Solid(1e7, 0.3, 2500), granular.SurfacePair(0.5, 0.5))
every = [
    collide.gravity(z=-1.62), collide.bounce(0.5), collide.friction(0.5, 0.4), collide.spin(), collide.drag(0.1),
    collide.periodic_box([-1, -1, -1], (1, 1, 1)), collide.moving_bodies(), collide.driven_bodies(),
    collide.granular_contact(granular.hertz(), granular.mindlin(damping="none"), granular.epsd(), materials=materials),
]
own = collide.Effect("spring", {"stiffness": 4.0}, code="struct spring {};")
body = collide.Body(0, 4, pivot=[0, 0, 1], rate=2.0)
sim = collide.Simulation(mesh, (effect for effect in every[:2]), swept=False, precision="exact")
sim.set(points, 0.05, velocities=None)
sim.steps(10, 1e-3, call=lambda done: print(f"{done} of 10"), every=5)
sim.step(1e-3)
sim.change("gravity", x=1.0)
sim["velocity"] = numpy.zeros((2, 3), numpy.float32)
positions: Any = sim["position"] if "position" in sim else None
energy: float = sim.energy(1.0)["kinetic"] + sim.time + sim.largest_time_step()
report: collide.ContactReport = sim.contact_report()
filled: Any = collide.fill(((0, 0, 0), (1, 1, 1)), ("uniform", 0.1, 0.2), 0.3, seed=1).centres
neighbours: Any = sim.contacts()


def of_other_scenes(other: collide.Simulation) -> Tuple[int, float, int]:
    """What needs other lists of effects."""
    other.set_mesh(mesh, [body])
    other.drive(0, 0.1, rate=1.0, shift=(0, 0, 1))
    impulses, flow = other.sums("reaction"), other.sums("mass_flow")
    other.clear("reaction")
    other.save("file")
    other.load("file")
    return other.births.due, flow.mass, impulses.refused


def of_other_libraries(drawn: Any) -> collide.Mesh:
    return collide.Mesh.of(drawn, threads=2)


def of_errors() -> str:
    try:
        collide.Mesh(vertices, triangles + 1)
    except (collide.Error, ValueError) as error:
        return str(error)
    return collide.__version__


print(of_errors())
