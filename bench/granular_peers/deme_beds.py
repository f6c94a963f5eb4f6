#!/usr/bin/env python3
"""deme_beds.py [SPHERES [STEPS]]: the beds `packed` and `clumps` of granular_bench.cpp in DEM-Engine (pip install DEME).

Prints a line of JSON for each: microseconds a step, the least of three times STEPS (1,000), by wall clock. All options but
material, box, step and gravity are the library's own; it looks for contacts in a thread beside, as it is made to do."""
import json
import sys
import time

import numpy
from DEME import DEMSolver

R, DT = 1e-3, 4e-6
MASS = 2500 * 4 / 3 * numpy.pi * R**3


def lattice(side, spacing, shake):
    """side^3 points, `spacing` (3 numbers) from each other, around the origin."""
    at = numpy.stack(numpy.meshgrid(*[numpy.arange(side)] * 3, indexing="ij"), -1).reshape(-1, 3) * spacing
    at = at - at.mean(axis=0)
    return at + shake * numpy.random.default_rng(1).uniform(-1, 1, at.shape)


def measure(name, spheres, template_of, spacing, size, middle, side, steps):
    solver = DEMSolver(1)
    solver.SetVerbosity("ERROR")
    material = solver.LoadMaterial({"E": 1e7, "nu": 0.3, "CoR": 0.5, "mu": 0.5, "Crr": 0.0})
    box = [float(s * (side - 1) + w) for s, w in zip(spacing, size)]
    solver.InstructBoxDomainDimension(*box)
    solver.InstructBoxDomainBoundingBC("all", material)
    solver.AddClumps(template_of(solver, material), (lattice(side, spacing, 0.002 * R) - middle).tolist())
    solver.SetInitTimeStep(DT)
    solver.SetGravitationalAcceleration([0, 0, -9.81])
    solver.Initialize()
    solver.DoDynamicsThenSync(200 * DT)
    took = []
    for _ in range(3):
        begin = time.perf_counter()
        solver.DoDynamicsThenSync(steps * DT)
        took.append((time.perf_counter() - begin) / steps)
    each = min(took)
    print(json.dumps({"code": "DEM-Engine", "scene": name, "spheres": spheres, "step_us": round(1e6 * each, 2),
                      "sphere_steps_per_s": float(f"{spheres / each:.4g}"),
                      "contacts_a_sphere": round(2 * solver.GetNumContacts() / spheres, 2)}), flush=True)


def main():
    spheres = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    steps = int(sys.argv[2]) if len(sys.argv) > 2 else 1_000
    side = round(spheres ** (1 / 3))
    measure("packed", side**3, lambda solver, material: solver.LoadSphereType(MASS, R, material),
            numpy.array([1.9985] * 3) * R, [1.998 * R] * 3, numpy.zeros(3), side, steps)
    # three spheres in a triangle, around their centre of mass
    places = numpy.array([[-0.6, -0.34667, 0], [0.6, -0.34667, 0], [0, 0.69333, 0]]) * R
    moment = [float(3 * 0.4 * MASS * R**2 + MASS * (numpy.delete(places, k, axis=1) ** 2).sum()) for k in range(3)]
    side = round((spheres / 3) ** (1 / 3))
    measure("clumps", 3 * side**3,
            lambda solver, material: solver.LoadClumpType(3 * MASS, moment, [R] * 3, places.tolist(), material),
            numpy.array([3.1985, 3.0385, 1.9985]) * R, [3.197 * R, 3.037 * R, 1.998 * R],
            (places.max(axis=0) + places.min(axis=0)) / 2, side, steps)


if __name__ == "__main__":
    main()
