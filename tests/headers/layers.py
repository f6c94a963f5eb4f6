"""Includes go one way: a header includes headers of its own layer and of those below, and never, through others, itself.
A layer is a folder of include/collide; the picture in docs/development/design.md has their order. The few headers in no folder are
those that users name first, and belong to the highest layer that they include.

Usage: layers.py check | self-test | including HEADER

`including` prints the headers that include this one, also through others, and itself.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = ROOT / "include" / "collide"
PAGE = ROOT / "docs" / "development" / "design.md"
MOST_WITHOUT_FOLDER = 12

def pictured_layers():
    """The folders of the picture in docs/development/design.md, from the lowest to the highest: each is a layer."""
    picture = PAGE.read_text().split("## Layers", 1)[1].split("\n## ", 1)[0]
    return re.findall(r"^    ([\w/]+/)  ", picture, re.MULTILINE)[::-1]


def read_headers():
    """The includes of each header, by its path below include/collide."""
    headers = {}
    for path in sorted([*INCLUDE.rglob("*.hpp"), *INCLUDE.rglob("*.cuh")]):
        name = path.relative_to(INCLUDE).as_posix()
        headers[name] = re.findall(r"^\s*#\s*include\s*<collide/([^>]+)>", path.read_text(), re.MULTILINE)
    return headers


def layer_of(header, headers, layers):
    """The number of the header's layer: of its folder, or of the nearest one above that is a layer; a header in no folder
    has the highest layer of those that it includes. None if there is none."""
    if "/" not in header:
        return max((layer_of(included, headers, layers) or 0 for included in headers.get(header, ())), default=None)
    inner = max((layer for layer in layers if header.startswith(layer)), key=len, default=None)
    return layers.index(inner) if inner else None


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


def problems(headers, layers):
    if sum("/" not in header for header in headers) > MOST_WITHOUT_FOLDER:
        yield f"more than {MOST_WITHOUT_FOLDER} headers are in no folder"
    finished = set()
    rings = [ring for header in headers for ring in rings_from(header, headers, finished)]
    yield from ("headers include each other: " + " -> ".join(ring) for ring in rings)
    if rings:
        return
    for header, includes in headers.items():
        layer = layer_of(header, headers, layers)
        if layer is None:
            yield f"{header} is in no layer: docs/development/design.md does not show its folder"
            continue
        for included in includes:
            if included not in headers:
                yield f"{header} includes {included}, which does not exist"
                continue
            above = layer_of(included, headers, layers)
            if above is not None and above > layer:
                yield f"{header} includes {included}, which is in a higher layer, {layers[above]}"


def self_test():
    """Faults that are planted are found, each by its own sentence."""
    layers = ["core/", "broad/detail/grid/", "broad/"]
    sound = {"mesh.hpp": ["core/geometry.hpp"], "core/geometry.hpp": [], "broad/detail/grid/grid.hpp": ["mesh.hpp"],
             "broad/extend.hpp": ["broad/detail/grid/grid.hpp"], "bucket.cuh": ["broad/extend.hpp", "mesh.hpp"]}
    plants = {
        "which is in a higher layer, broad/": {**sound, "broad/detail/grid/grid.hpp": ["broad/new.hpp"], "broad/new.hpp": []},
        "includes bvh.cuh, which is in a higher": {**sound, "core/config.hpp": ["bvh.cuh"], "bvh.cuh": ["broad/new.hpp"], "broad/new.hpp": []},
        "in no layer": {**sound, "misc/grid.hpp": []},
        "does not exist": {**sound, "core/geometry.hpp": ["core/gone.hpp"]},
        "include each other": {**sound, "core/geometry.hpp": ["core/config.hpp"], "core/config.hpp": ["core/geometry.hpp"]},
        "are in no folder": {**sound, **{f"{name}.hpp": [] for name in "abcdefghijklm"}},
    }
    yield from problems(sound, layers)
    for sentence, headers in plants.items():
        if not any(sentence in problem for problem in problems(headers, layers)):
            yield f"a planted fault was not found: {sentence}"
    if including("mesh.hpp", sound) != ["broad/detail/grid/grid.hpp", "broad/extend.hpp", "bucket.cuh", "mesh.hpp"]:
        yield "including: who includes mesh.hpp is not known"


def check():
    headers, layers = read_headers(), pictured_layers()
    yield from problems(headers, layers)
    for layer in layers:
        if not any(header.startswith(layer) for header in headers):
            yield f"docs/development/design.md shows {layer}, where there is no header"


if __name__ == "__main__":
    if sys.argv[1] == "including":
        print("\n".join(including(sys.argv[2], read_headers())))
        sys.exit()
    found = list({"check": check, "self-test": self_test}[sys.argv[1]]())
    print("\n".join(found) or "fine")
    sys.exit(bool(found))
