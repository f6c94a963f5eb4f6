"""Makes lists.hpp: lists of effects in which each pair of effects stands together.

Usage: make_lists.py                 writes lists.hpp
       make_lists.py --check         says whether lists.hpp is that, covers all, and is in the tests
       make_lists.py --pairs [NAME]  prints which lists cover which pair (of an effect)

Each effect also stands with each kind of surface, each narrow phase and each scalar.
"""

import itertools
import pathlib
import random
import sys

HERE = pathlib.Path(__file__).resolve().parent
HEADER = HERE / "lists.hpp"
LONGEST = 8  # effects of a list
TRIES = 300  # of which the list that covers most is taken

EFFECTS = """velocity_verlet gravity drag wind bounce friction spin adhesion sphere_contact sleep emit absorb
    absorbing_box box_walls periodic_box polydisperse lost_motion lost mesh_forces pair_forces reaction warms""".split()
TYPES = {"wind": "wind<>", "warms": "tests::pairs::warms"}
SURFACES = ["at_rest", "body", "driven_body", "deforming"]
MOVING = {"body": "moving_bodies<>", "driven_body": "moving_bodies<collide::driven>", "deforming": "moving_bodies<>"}
NARROW_PHASES = ["karabassi", "karabassi_swept"]
SCALARS = ["float", "double"]
FACTORS = [SURFACES, NARROW_PHASES, SCALARS]

# One of these must be in the list, too; what a simulation without them says is in tests/compile_fail.
REQUIRED = {"friction": ["bounce"], "adhesion": ["bounce"], "spin": ["bounce", "sphere_contact"]}
# A user's effect between particles that changes no velocity does not compile alone with velocity_verlet or adhesion.
NEEDS = {**REQUIRED, "warms": ["sphere_contact"]}
# runs_after of the effects; pair_forces sees nothing of a user's effect that comes after it.
AFTER = {
    "friction": ["bounce"],
    "spin": ["bounce"],
    "adhesion": ["bounce"],
    "mesh_forces": ["bounce", "friction", "spin", "adhesion"],
    "reaction": ["bounce", "friction", "spin", "adhesion"],
    "pair_forces": ["sphere_contact", "warms"],
}
# Where momentum closes, and energy does not grow: few of the other lists say anything of these.
FIRST = [
    ("velocity_verlet gravity sphere_contact bounce friction spin reaction", ("body", "karabassi_swept", "double")),
    ("gravity sphere_contact bounce adhesion mesh_forces pair_forces reaction", ("driven_body", "karabassi", "float")),
    ("polydisperse sphere_contact gravity bounce friction spin sleep reaction", ("at_rest", "karabassi", "float")),
    ("velocity_verlet gravity bounce adhesion lost reaction", ("deforming", "karabassi_swept", "double")),
    ("velocity_verlet gravity sphere_contact bounce polydisperse reaction", ("at_rest", "karabassi_swept", "double")),
]


def pair(a, b):
    return tuple(sorted((a, b)))


def all_pairs():
    found = {pair(a, b) for a, b in itertools.combinations(EFFECTS, 2)}
    return found | {pair(e, v) for values in FACTORS for v in values for e in EFFECTS}


def covered(effects, factors):
    return {pair(a, b) for a, b in itertools.combinations([*effects, *factors], 2)}


def needed(effect, chosen, rng):
    """What must be added with an effect."""
    of = NEEDS.get(effect, [])
    return [] if not of or set(of) & set(chosen) else [rng.choice(of)]


def try_list(left, rng):
    """A list that begins with a pair that is left, and grows by what covers most."""
    first, second = rng.choice(sorted(left))
    factors = [second if second in values else first if first in values else rng.choice(values) for values in FACTORS]
    chosen = []

    def add(effect):
        if effect not in chosen:
            chosen.extend([*needed(effect, [*chosen, effect], rng), effect])

    for one in (first, second):
        if one in EFFECTS:
            add(one)
    longest = LONGEST - (factors[0] != "at_rest")
    while len(chosen) < longest:
        now = len(left & covered(chosen, factors))
        rest = [e for e in EFFECTS if e not in chosen and len(chosen) + 1 + len(needed(e, chosen, rng)) <= longest]
        if not rest:
            break
        gains = {e: len(left & covered([*chosen, e], factors)) - now for e in rest}
        most = max(gains.values())
        if most == 0 and len(chosen) >= 5:
            break
        add(rng.choice([e for e in rest if gains[e] == most]))
    return chosen, factors


def in_order(effects, rng):
    """A random order in which each effect comes after those that it uses."""
    left, ordered = sorted(effects), []
    while left:
        free = [e for e in left if not set(AFTER.get(e, [])) & (set(left) - {e})]
        ordered.append(rng.choice(free))
        left.remove(ordered[-1])
    return ordered


def make_lists():
    rng, left, lists = random.Random(43), all_pairs(), []
    for names, factors in FIRST:
        left -= covered(names.split(), factors)
        lists.append((in_order(names.split(), rng), factors))
    while left:
        tries = [try_list(left, rng) for _ in range(TRIES)]
        effects, factors = max(tries, key=lambda t: len(left & covered(*t)))
        left -= covered(effects, factors)
        lists.append((in_order(effects, rng), factors))
    return lists


def type_of(effect):
    name = TYPES.get(effect, effect)
    return name if "::" in name else f"collide::{name}"


def header(lists):
    lines = [
        "/// Made by make_lists.py: lists of effects in which each pair of effects stands together, and each effect with each",
        "/// kind of surface, narrow phase and scalar.",
        "#pragma once",
        "",
        '#include "check_list.hpp"',
        "",
        "namespace tests::pairs {",
        "",
        "// clang-format off",
    ]
    for number, (effects, (surface, narrow, scalar)) in enumerate(lists, 1):
        types = [type_of(e) for e in effects]
        if surface in MOVING:
            types.append(f"collide::{MOVING[surface]}")
        lines.append(f"using list_{number} = scene_list<surface::{surface}, collide::{narrow}<>, {scalar},")
        lines.append(f"    {', '.join(types)}>;")
    return "\n".join([*lines, "// clang-format on", "", "}  // namespace tests::pairs", ""])


def problems(lists):
    if not HEADER.exists() or HEADER.read_text() != header(lists):
        yield "lists.hpp is not what make_lists.py makes: run it"
    left = all_pairs()
    for number, (effects, factors) in enumerate(lists, 1):
        left -= covered(effects, factors)
        for effect, before in AFTER.items():
            if effect in effects and any(b in effects and effects.index(b) > effects.index(effect) for b in before):
                yield f"list {number}: {effect} comes too early"
        if not 5 <= len(effects) + (factors[0] != "at_rest") <= LONGEST:
            yield f"list {number} has {len(effects)} effects"
    if left:
        yield f"no list covers {sorted(left)}"
    tests = "".join(path.read_text() for path in sorted(HERE.glob("test_*.cpp")))
    for number in range(1, len(lists) + 1):
        if f"list_{number}>" not in tests:
            yield f"no test checks list_{number}"


def print_pairs(lists, name):
    for one in sorted(all_pairs()):
        if name is None or name in one:
            of = [n for n, (effects, factors) in enumerate(lists, 1) if one in covered(effects, factors)]
            print(f"{one[0]}, {one[1]}: {', '.join(map(str, of))}")
    for effect, of in REQUIRED.items():
        print(f"{effect}: does not compile without {' or '.join(of)}, or an effect of a user's that does the same")
    print("two integrators, two sources: do not compile")
    print("An effect stands with moving_bodies where it does with body, driven_body or deforming.")


def main(arguments):
    lists = make_lists()
    if arguments[:1] == ["--pairs"]:
        print_pairs(lists, arguments[1] if len(arguments) > 1 else None)
    elif arguments == ["--check"]:
        found = list(problems(lists))
        print("\n".join(found) or f"{len(lists)} lists cover {len(all_pairs())} pairs")
        return bool(found)
    elif arguments:
        print(__doc__)
        return True
    else:
        HEADER.write_text(header(lists))
        print(f"{len(lists)} lists")
    return False


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
