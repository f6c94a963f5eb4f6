#!/usr/bin/env python3
"""bench/granular_peers/decks.py PENETRATION_BED DRUM_BED FOLDER

Writes what the input decks here read, into FOLDER: penetration.data and drum.data for LIGGGHTS, of beds as
`granular_benchmark SCENE bed FILE` writes them (radius and centre of each grain, one a line), and the drum's walls. There:
    liggghts -var steps 60000 -in liggghts_penetration.in
    liggghts -var steps 20000 -in liggghts_drum.in
    yade -n -x yade_penetration.py PENETRATION_BED STEPS CURVE.csv
"""
import math
import pathlib
import sys

FALLEN = 0.02  # s, in which the ball has fallen freely
RADIUS, HALF, SIDES = 0.1, 0.03, 314  # of the drum


def grains_of(path):
    """(radius, x, y, z) of each grain."""
    for line in pathlib.Path(path).read_text().splitlines():
        try:
            numbers = tuple(float(word) for word in line.split())
        except ValueError:
            continue
        if len(numbers) == 4 and numbers[0] < 0.005:
            yield numbers


def write_data(path, bounds, grains):
    """Grains as (type, radius, density, x, y, z)."""
    lines = ["grains", "", f"{len(grains)} atoms", "3 atom types",
             *(f"{low} {high} {axis}lo {axis}hi" for axis, (low, high) in zip("xyz", bounds)), "", "Atoms", ""]
    lines += [f"{k} {kind} {2 * r:.12g} {density} {x:.12g} {y:.12g} {z:.12g}"
              for k, (kind, r, density, x, y, z) in enumerate(grains, 1)]
    path.write_text("\n".join(lines) + "\n")


def write_stl(path, triangles):
    with open(path, "w", encoding="ascii") as file:
        file.write("solid wall\n")
        for corners in triangles:
            file.write("facet normal 0 0 0\nouter loop\n")
            file.writelines(f"vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in corners)
            file.write("endloop\nendfacet\n")
        file.write("endsolid wall\n")


def quad(a, b, c, d):
    return [(a, b, c), (a, c, d)]


def main(arguments):
    if len(arguments) != 3:
        sys.exit(__doc__.strip())
    folder = pathlib.Path(arguments[2])
    ball = (3, 0.01, 7200, 0.0, 0.0, 0.06 - 5 * FALLEN - 0.5 * 9.81 * FALLEN**2)
    write_data(folder / "penetration.data", ((-0.051, 0.051), (-0.031, 0.031), (-0.0912, 0.12)),
               [*((1, r, 2500, *x) for r, *x in grains_of(arguments[0])), ball])
    write_data(folder / "drum.data", ((-0.15, 0.15), (-0.04, 0.04), (-0.15, 0.15)),
               [(2, r, 2000, *x) if r > 0.0015 else (1, r, 2500, *x) for r, *x in grains_of(arguments[1])])

    def rim(k, y):
        angle = 2 * math.pi * (k % SIDES) / SIDES
        return RADIUS * math.cos(angle), y, RADIUS * math.sin(angle)

    write_stl(folder / "ring.stl", [t for k in range(SIDES)
                                    for t in quad(rim(k, -HALF), rim(k + 1, -HALF), rim(k + 1, HALF), rim(k, HALF))])
    for name, y in (("end0", -HALF), ("end1", HALF)):
        write_stl(folder / f"{name}.stl", quad(*((x, y, z) for x, z in ((-RADIUS, -RADIUS), (RADIUS, -RADIUS),
                                                                         (RADIUS, RADIUS), (-RADIUS, RADIUS)))))


if __name__ == "__main__":
    main(sys.argv[1:])
