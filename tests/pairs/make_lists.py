"""Makes lists of effects in which each pair of effects stands together with each kind of surface, with each narrow
phase and with each scalar.

Usage: make_lists.py                 writes lists.hpp and the tests, one file for each narrow phase and scalar
       make_lists.py --check         says whether they are what this script makes, and cover all
       make_lists.py --pairs [NAME]  prints which lists cover which pair (of an effect), and what cannot be combined

A list is of a kind of mesh: fixed, with moving bodies, or with driven ones. A test plays it on all surfaces of its kind.
"""

import collections
import itertools
import pathlib
import random
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
HEADER = HERE / "lists.hpp"
FAILING = HERE.parent / "compile_fail"
LONGEST = 12  # effects of a list, moving_bodies aside: a longer one takes longer to compile, and fewer are needed
TRIES = 60  # of which the list that covers most is taken

EFFECTS = """velocity_verlet gravity drag wind bounce friction spin adhesion sphere_contact sleep emit absorb
    absorbing_box box_walls periodic_box polydisperse lost_motion lost mesh_forces pair_forces reaction warms
    granular_contact external_forces mass_flow""".split()
BY_FORCES = "granular_contact"  # makes the mesh solid by forces
ACTS_BY_IMPULSES = ["bounce", "friction", "spin", "adhesion", "absorb", "warms"]  # these do not compile beside it
TYPES = {"wind": "wind<>", "warms": "tests::pairs::warms", "external_forces": "tests::pairs::stirs", "mass_flow": "mass_flow<>", "wear": "wear<>",
         "contact_work": "contact_work<>"}
LAWS = {  # of contact by forces, of which the lists of a scalar take turns: one that remembers nothing, and those that do
    "float": ["granular_contact<collide::linear, collide::dashpot>",
              "granular_contact<collide::linear, collide::cundall_strack, collide::marshall<collide::epsd>>"],
    "double": ["granular_contact<collide::hertz, collide::mindlin_force, collide::epsd2, collide::sjkr>",
               "granular_contact<collide::hertz, collide::mindlin, collide::epsd>"],
}
BODIES = {"fixed": [], "moving": ["collide::moving_bodies<>"], "driven": ["collide::moving_bodies<collide::driven>"]}
SURFACES = {  # of the kinds of mesh
    "fixed": ["at_rest"],
    "moving": ["at_rest", "body", "deforming"],
    "driven": ["at_rest", "driven_body", "deforming"],
}
NARROW_PHASES = ["karabassi", "karabassi_swept"]
SCALARS = ["float", "double"]
TESTS = {(n, s): HERE / f"test_{n}_{s}.cpp" for n in NARROW_PHASES for s in SCALARS}

# One of these must be in the list, too; what a simulation without them says is in tests/compile_fail.
REQUIRED = {"friction": ["bounce"], "adhesion": ["bounce"], "spin": ["bounce", "sphere_contact"]}
# Other orders do not compile: friction and adhesion need_solid_mesh, pair_forces follows_pair_contacts.
AFTER = {
    "friction": ["bounce"],
    "adhesion": ["bounce"],
    "pair_forces": ["sphere_contact", "warms", BY_FORCES],
}
# Where momentum closes, energy does not grow, and what rests presses with its weight: few of the other lists say
# anything of these.
FIRST = [
    ("velocity_verlet gravity sphere_contact bounce friction spin reaction", ("moving", "karabassi_swept", "double")),
    ("gravity sphere_contact bounce adhesion mesh_forces pair_forces reaction", ("driven", "karabassi", "float")),
    ("polydisperse sphere_contact gravity bounce friction spin sleep reaction", ("moving", "karabassi", "float")),
    ("velocity_verlet gravity bounce adhesion lost reaction", ("driven", "karabassi_swept", "double")),
    ("velocity_verlet gravity sphere_contact bounce polydisperse reaction", ("fixed", "karabassi_swept", "double")),
    ("gravity bounce friction spin adhesion sleep mesh_forces reaction", ("fixed", "karabassi", "float")),
    ("velocity_verlet gravity sphere_contact bounce friction spin adhesion sleep reaction",
     ("moving", "karabassi", "double")),
    ("velocity_verlet gravity granular_contact sleep mesh_forces reaction", ("driven", "karabassi", "float")),
    ("velocity_verlet gravity granular_contact polydisperse lost pair_forces reaction",
     ("moving", "karabassi", "double")),
]
# Those in which a hunt found something, in their order: test_hunt.cpp finds them by their effects.
FOUND = [
    ("sphere_contact sleep granular_contact mesh_forces lost absorbing_box lost_motion emit reaction",
     ("driven", "karabassi", "double")),
]
# Behind all others, of effects that only go with few: they are in no pair that must be covered.
LAST = [
    ("velocity_verlet gravity granular_contact wear contact_work mesh_forces reaction polydisperse lost", ("moving", "karabassi", "double")),
    ("velocity_verlet gravity granular_contact clumps contact_work mesh_forces reaction pair_forces lost periodic_box", ("moving", "karabassi", "double")),
    ("velocity_verlet gravity wind external_forces granular_contact wear clumps mass_flow absorbing_box polydisperse lost_motion mesh_forces",
     ("driven", "karabassi", "float")),
    ("sleep gravity emit granular_contact wear contact_work lost reaction periodic_box", ("driven", "karabassi", "float")),
    ("gravity sphere_contact contact_work polydisperse periodic_box lost", ("fixed", "karabassi", "float")),
    ("velocity_verlet gravity granular_contact wear sleep clumps contact_work mesh_forces reaction polydisperse lost", ("driven", "karabassi", "double")),
    ("velocity_verlet gravity granular_contact sleep clumps pair_forces external_forces contact_work mass_flow absorbing_box periodic_box",
     ("moving", "karabassi", "float")),
    ("velocity_verlet sphere_contact gravity absorb clumps mass_flow sleep polydisperse", ("driven", "karabassi_swept", "float")),
]
# Pairs that do not compile: the test of tests/compile_fail, and the reason.
REFUSED = {
    "friction_without_bounce": "friction or adhesion without bounce, or an effect of a user's with `repels`",
    "friction_before_bounce": "friction or adhesion before bounce, or before an effect of a user's with `repels`",
    "spin_without_contacts": "spin without bounce, sphere_contact or an effect of a user's that does the same",
    "pair_forces_before_granular_contact": "pair_forces before an effect that acts between particles",
    "wear_before_granular_contact": "wear before granular_contact, or without it",
    "granular_contact_with_bounce": "granular_contact beside bounce, friction, spin, adhesion or absorb, which act where "
    "particles hit the mesh",
    "granular_contact_that_sweeps": "granular_contact with karabassi_swept",
    "clumps_with_bounce": "clumps beside bounce, friction, spin or adhesion",
    "clumps_with_box_walls": "clumps beside box_walls",
    "clumps_without_velocity_verlet": "clumps without velocity_verlet and contact by forces",
    "two_integrators": "two integrators",
    "two_sources": "two sources",
    "two_kinds_of_bodies": "two kinds of bodies",
}

List = collections.namedtuple("List", "effects kind narrow scalar")
CIRCUMSTANCES = [*sorted({s for of in SURFACES.values() for s in of}), *NARROW_PHASES, *SCALARS]



def circumstances(one):
    """Those in which the pairs of a list meet."""
    return [*SURFACES[one.kind], one.narrow, one.scalar]


def meeting(a, b, circumstance):
    return (*sorted((a, b)), circumstance)


def do_not_compile(a, b):
    return BY_FORCES in (a, b) and bool({a, b} & set(ACTS_BY_IMPULSES))


def sweeps(circumstance):
    """Does an effect by forces not compile there?"""
    return circumstance == "karabassi_swept"


def every_meeting():
    pairs = [p for p in itertools.combinations(sorted(EFFECTS), 2) if not do_not_compile(*p)]
    return {(*p, c) for p in pairs for c in CIRCUMSTANCES if not (BY_FORCES in p and sweeps(c))}


def covered(one):
    return {meeting(a, b, c) for a, b in itertools.combinations(one.effects, 2) for c in circumstances(one)}


def needed(effect, chosen, rng):
    """The effects that must be added with an effect."""
    of = REQUIRED.get(effect, [])
    return [] if not of or set(of) & set(chosen) else [rng.choice(of)]


def try_list(left, in_order, file, rng):
    """A list of a file that begins with a meeting that is left, and grows by what covers most."""
    first, second, where = rng.choice(in_order)
    if BY_FORCES in (first, second) and sweeps(file[0]):
        file = ("karabassi", file[1])
    kinds = [k for k in BODIES if k != "fixed" and (where in SURFACES[k] or where in NARROW_PHASES + SCALARS)]
    one = List([], rng.choice(kinds), *file)
    chosen, factors = one.effects, circumstances(one)

    def gain(effect):
        return sum(meeting(effect, other, c) in left for other in chosen for c in factors)

    def add(effect):
        for e in [*needed(effect, [*chosen, effect], rng), effect]:
            if e not in chosen:
                total[0] += gain(e)
                chosen.append(e)

    total = [0]
    add(first)
    add(second)
    while len(chosen) < LONGEST:
        others = [e for e in EFFECTS if not any(do_not_compile(e, c) for c in chosen)]
        others = [e for e in others if not (e == BY_FORCES and sweeps(one.narrow))]
        rest = [e for e in others if e not in chosen and len(chosen) + 1 + len(needed(e, chosen, rng)) <= LONGEST]
        gains = {e: gain(e) for e in rest}
        most = max(gains.values(), default=0)
        if most == 0:
            break
        add(rng.choice([e for e in rest if gains[e] == most]))
    return total[0], one


def in_order(effects, rng):
    """A random order in which each effect comes after those that it uses."""
    left, ordered = sorted(effects), []
    while left:
        free = [e for e in left if not set(AFTER.get(e, [])) & (set(left) - {e})]
        ordered.append(rng.choice(free))
        left.remove(ordered[-1])
    return ordered


def make_lists():
    rng, left, lists = random.Random(3), every_meeting(), []  # of twelve seeds that of the fewest lists

    def add(one):
        left.difference_update(covered(one))
        lists.append(one)

    def add_in_order(one):
        add(one._replace(effects=in_order(one.effects, rng)))

    for names, (kind, narrow, scalar) in FIRST:
        add_in_order(List(names.split(), kind, narrow, scalar))
    for names, (kind, narrow, scalar) in FOUND:
        add(List(names.split(), kind, narrow, scalar))
    while left:
        ordered = sorted(left)
        files = sorted(TESTS, key=lambda t: sum((one.narrow, one.scalar) == t for one in lists))[:2]
        tries = [try_list(left, ordered, rng.choice(files), rng) for _ in range(TRIES)]
        add_in_order(max(tries, key=lambda t: t[0])[1])
    for names, (kind, narrow, scalar) in LAST:
        add(List(names.split(), kind, narrow, scalar))
    return lists


def type_of(effect, turn, scalar):
    name = LAWS[scalar][turn % len(LAWS[scalar])] if effect == BY_FORCES else TYPES.get(effect, effect)
    return name if name.startswith("tests::") else f"collide::{name}"


def header(lists):
    lines = [
        "/// Made by make_lists.py: lists of effects in which each pair of effects stands together on each kind of surface,",
        "/// with each narrow phase and each scalar.",
        "#pragma once",
        "",
        '#include "check_list.hpp"',
        "",
        "namespace tests::pairs {",
        "",
        "// clang-format off",
    ]
    turns = collections.Counter()
    for number, (effects, kind, narrow, scalar) in enumerate(lists, 1):
        types = [*(type_of(e, turns[scalar], scalar) for e in effects), *BODIES[kind]]
        turns[scalar] += BY_FORCES in effects
        lines.append(f"using list_{number} = scene_list<mesh_kind::{kind}, collide::{narrow}<>, {scalar},")
        lines.append(f"    {', '.join(types)}>;")
    return "\n".join([*lines, "// clang-format on", "", "}  // namespace tests::pairs", ""])


def test_file(lists, narrow, scalar):
    of = [n for n, one in enumerate(lists, 1) if (one.narrow, one.scalar) == (narrow, scalar)]
    lines = [f"/// Made by make_lists.py: the lists with {narrow} and {scalar}.", '#include "hunt.hpp"', '#include "lists.hpp"', ""]
    lines += ["using namespace tests::pairs;", "", "// clang-format off"]
    for n in of:
        lines.append(f'TEST_CASE("pairs: list {n}") {{ check_list<list_{n}>(); }}')
        lines.append(f'static bool const list_{n}_is_hunted = hunt<list_{n}>("{n}", "{" ".join(lists[n - 1].effects)}");')
    return "\n".join([*lines, ""])


def files(lists):
    return {HEADER: header(lists), **{path: test_file(lists, *of) for of, path in TESTS.items()}}


def problems(lists):
    for path, text in files(lists).items():
        if not path.exists() or path.read_text() != text:
            yield f"{path.name} is not what make_lists.py makes: run it"
    left = every_meeting()
    for number, one in enumerate(lists, 1):
        effects = one.effects
        left -= covered(one)
        for effect, before in AFTER.items():
            if effect in effects and any(b in effects and effects.index(b) > effects.index(effect) for b in before):
                yield f"list {number}: {effect} comes too early"
        if len(effects) > LONGEST:
            yield f"list {number} has {len(effects)} effects"
    if left:
        yield f"no list covers {sorted(left)}"
    for name in REFUSED:
        if not (FAILING / f"{name}.cpp").exists():
            yield f"no test of what does not compile: {name}"


def print_pairs(lists, name):
    for a, b in itertools.combinations(sorted(EFFECTS), 2):
        if name is None or name in (a, b):
            of = {n: one for n, one in enumerate(lists, 1) if {a, b} <= set(one.effects)}
            where = [f"{c} {'/'.join(str(n) for n in of if c in circumstances(of[n]))}" for c in CIRCUMSTANCES]
            print(f"{a}, {b}: {', '.join(where)}")
    for test, what in REFUSED.items():
        sentence = (FAILING / f"{test}.cpp").read_text().splitlines()[0].removeprefix("// expect: ")
        if name is None or re.search(rf"\b{name}\b", what):
            print(f"does not compile: {what}: {sentence}")


def main(arguments):
    lists = make_lists()
    if arguments[:1] == ["--pairs"]:
        print_pairs(lists, arguments[1] if len(arguments) > 1 else None)
    elif arguments == ["--check"]:
        found = list(problems(lists))
        print("\n".join(found) or f"{len(lists)} lists cover {len(every_meeting())} meetings of two effects")
        return bool(found)
    elif arguments:
        print(__doc__)
        return True
    else:
        for path, text in files(lists).items():
            path.write_text(text)
        print(f"{len(lists)} lists")
    return False


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
