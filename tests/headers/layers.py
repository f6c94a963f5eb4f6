"""Includes go one way: a header includes headers of its own layer and of those below, and never, through others, itself.

Usage: layers.py check | self-test | including HEADER

`including` prints the headers that include this one, also through others, and itself.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = ROOT / "include" / "collide"
PAGE = ROOT / "docs" / "design.md"

# From the lowest to the highest: the headers of a layer, and the folders of which all headers are its own.
LAYERS = {
    "vocabulary": "config.hpp contact.hpp error.hpp geometry.hpp impact.hpp memory.hpp nearest_triangle.hpp precision.hpp version.hpp",
    "views": "mesh.hpp moving_spheres.hpp points.hpp spheres.hpp",
    "execution": "detail/execution/ atomic_add.hpp cuda.cuh cuda_memory.cuh host.hpp upload.hpp",
    "numeric": "detail/numeric/",
    "geometry": "detail/geometry/",
    "predicates": "detail/predicates/",
    "narrow phase": "detail/narrow_phase/ detail/nearest/ karabassi.hpp karabassi_swept.hpp",
    "grid": "detail/grid/ detail/tree/",
    "query": "detail/query/ concepts.hpp hit.hpp",
    "sinks": "detail/sinks/ sinks/",
    "detector": "compiled.hpp detector.hpp self_intersections.hpp validate.hpp validate_closed.hpp validate_surface.hpp",
    "broad phases": "all_pairs.cuh automatic.cuh bucket.cuh bvh.cuh extend.hpp",
    "effect interface": "bodies.hpp columns.hpp effect.hpp integrators.hpp",
    "particles": "detail/particles/",
    "bodies": "detail/bodies/",
    "neighbours": "detail/neighbours/ sphere_pairs.cuh",
    "step": "detail/step/",
    "simulation": "checkpoint.hpp simulation.cuh",
    "effects": "effects/ energy.hpp",
    "streaming": "detail/streaming/ in_passes.hpp posed.hpp streamed.cuh",
    "ranks": "detail/ranks/ ranks/",
    "files": "detail/io/ io/",
}


def pictured_layers():
    """The layers of the picture in docs/design.md, from the lowest to the highest."""
    picture = PAGE.read_text().split("## Layers", 1)[1].split("\n## ", 1)[0]
    return re.findall(r"^    (\w+(?: \w+)*)  ", picture, re.MULTILINE)[::-1]


def read_headers():
    """The includes of each header, by its path below include/collide."""
    headers = {}
    for path in sorted([*INCLUDE.rglob("*.hpp"), *INCLUDE.rglob("*.cuh")]):
        name = path.relative_to(INCLUDE).as_posix()
        headers[name] = re.findall(r"^\s*#\s*include\s*<collide/([^>]+)>", path.read_text(), re.MULTILINE)
    return headers


def layer_of(header):
    """The number of the header's layer; None if it has none."""
    for number, members in enumerate(LAYERS.values()):
        for member in members.split():
            if header == member or (member.endswith("/") and header.startswith(member)):
                return number
    return None


def rings_from(header, headers, finished, path=()):
    """Headers that include each other in a ring, as far as they are reached from this one by unfinished ones."""
    if header in path:
        yield path[path.index(header):] + (header,)
        return
    if header in finished:
        return
    for included in headers.get(header, ()):
        yield from rings_from(included, headers, finished, path + (header,))
    finished.add(header)


def including(wanted, headers):
    found, before = {wanted}, set()
    while found != before:
        before, found = found, found | {header for header, includes in headers.items() if found.intersection(includes)}
    return sorted(found)


def problems(headers):
    names = list(LAYERS)
    for header, includes in headers.items():
        layer = layer_of(header)
        if layer is None:
            yield f"{header} is in no layer: name it in tests/headers/layers.py"
            continue
        for included in includes:
            if included not in headers:
                yield f"{header} includes {included}, which does not exist"
                continue
            above = layer_of(included)
            if above is not None and above > layer:
                yield f"{header} ({names[layer]}) includes {included} ({names[above]}), which is a higher layer"
    finished = set()
    for header in headers:
        for ring in rings_from(header, headers, finished):
            yield "headers include each other: " + " -> ".join(ring)


def self_test():
    """Faults that are planted are found, each by its own sentence."""
    sound = {"mesh.hpp": ["geometry.hpp"], "geometry.hpp": [], "broad/detail/grid/grid.hpp": ["mesh.hpp"]}
    plants = {
        "higher layer": {**sound, "mesh.hpp": ["geometry.hpp", "broad/detail/grid/grid.hpp"]},
        "in no layer": {**sound, "detail/misc/grid.hpp": []},
        "does not exist": {**sound, "mesh.hpp": ["geometry.hpp", "detail/gone.hpp"]},
        "include each other": {**sound, "geometry.hpp": ["config.hpp"], "config.hpp": ["geometry.hpp"]},
    }
    yield from problems(sound)
    for sentence, headers in plants.items():
        if not any(sentence in problem for problem in problems(headers)):
            yield f"a planted fault was not found: {sentence}"
    if including("mesh.hpp", sound) != ["broad/detail/grid/grid.hpp", "mesh.hpp"]:
        yield "including: who includes mesh.hpp is not known"


def check():
    yield from problems(read_headers())
    if pictured_layers() != list(LAYERS):
        yield f"docs/design.md shows other layers: {', '.join(pictured_layers())}"


if __name__ == "__main__":
    if sys.argv[1] == "including":
        print("\n".join(including(sys.argv[2], read_headers())))
        sys.exit()
    found = list({"check": check, "self-test": self_test}[sys.argv[1]]())
    print("\n".join(found) or "fine")
    sys.exit(bool(found))
