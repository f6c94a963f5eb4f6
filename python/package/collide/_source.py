"""Lists of effects as C++: the source of a simulation, and the lists that the package has compiled."""

import hashlib

# name: (type in C++, header, parameters). A parameter is (name, default, member); three numbers where the default has three.
_INF = float("inf")


def _same(**defaults):
    return [(name, value, name) for name, value in defaults.items()]


EFFECTS = {
    "gravity": ("gravity", "gravity", _same(x=0, y=0, z=-9.81)),
    "drag": ("drag", "drag", _same(linear=0, quadratic=0)),
    "wind": (
        "wind<>", "wind",
        _same(linear=0, quadratic=0) + [("x", 0, "field.x"), ("y", 0, "field.y"), ("z", 0, "field.z")],
    ),
    "bounce": ("bounce", "bounce", _same(restitution=0.5)),
    "friction": ("friction", "friction", _same(static_coefficient=0.5, kinetic_coefficient=0.5)),
    "spin": ("spin", "spin", _same(rolling_resistance=0)),
    "adhesion": ("adhesion", "adhesion", _same(max_acceleration=20, capture_speed=_INF)),
    "sphere_contact": (
        "sphere_contact", "sphere_contact",
        _same(stiffness=1000, damping=0, friction=0, tangential_damping=0, density=1),
    ),
    "sleep": ("sleep", "sleep", _same(speed=0.01, steps=50)),
    "emit": (
        "emit", "emit",
        _same(rate=0, radius=0, only_where_free=0) + [
            ("position", (0, 0, 0), "source.position"), ("half_width", 0, "source.half_width"),
            ("velocity", (0, 0, 0), "source.velocity"), ("velocity_spread", 0, "source.velocity_spread"),
        ],
    ),
    "absorb": ("absorb", "absorb", []),
    "absorbing_box": ("absorbing_box", "absorb", _same(lower=(0, 0, 0), upper=(0, 0, 0))),
    "box_walls": ("box_walls", "bounds", _same(lower=(-_INF,) * 3, upper=(_INF,) * 3, restitution=0.5)),
    "periodic_box": ("periodic_box", "bounds", _same(lower=(0, 0, 0), upper=(1, 1, 1))),
    "polydisperse": ("polydisperse", "polydisperse", []),
    "lost": ("lost", "lost", []),
    "lost_motion": ("lost_motion", "lost_motion", []),
    "mesh_forces": ("mesh_forces", "contact_forces", _same(density=1)),
    "pair_forces": ("pair_forces", "contact_forces", _same(density=1)),
    "moving_bodies": ("moving_bodies<>", None, []),
    "velocity_verlet": ("velocity_verlet", None, []),
}

#: The lists that are compiled in the package, float32 and exact, with karabassi.
BUILT_IN = [
    "gravity",
    "gravity bounce",
    "gravity bounce friction",
    "gravity bounce friction spin",
    "gravity sphere_contact",
    "gravity sphere_contact bounce",
    "gravity sphere_contact bounce friction",
    "emit gravity sphere_contact bounce friction spin",
    "polydisperse gravity sphere_contact bounce friction",
    "gravity sphere_contact bounce friction moving_bodies",
]

_PRECISIONS = {"exact": "exact", "double": "double_precision", "single": "single_precision"}


def source(effects, space="host", scalar="float", precision="exact", swept=False):
    """C++ for a list. An effect is a name of EFFECTS, or (type in C++, code, [(name, default, member)])."""
    headers, own, members, types = {"bodies.hpp", "integrators.hpp"}, {}, {}, []
    for effect in effects:
        if isinstance(effect, str):
            kind, header, parameters = EFFECTS[effect]
            kind = "collide::" + kind
            if header is not None:
                headers.add(f"effects/{header}.hpp")
        else:
            kind, code, parameters = effect
            own[code] = None
        types.append(kind)
        members[kind] = parameters
    text = "".join(f"#include <collide/{header}>\n" for header in sorted(headers))
    if own:  # what a user's own effect may need
        text += "#include <collide/effect.hpp>\n" + "".join(f"{code}\n" for code in own)
    text += "namespace collide_python {\n"
    for kind, parameters in members.items():
        calls = " ".join(f'f("{name}", e.{member});' for name, _, member in parameters)
        unused = "" if parameters else "[[maybe_unused]] "
        text += f"template <class F> void parameters({unused}{kind}& e, {unused}F const& f) {{ {calls} }}\n"
    text += '}\n#include "simulation_of.hpp"\n'
    narrow = f"collide::karabassi{'_swept' if swept else ''}<collide::{_PRECISIONS[precision]}>"
    if swept:
        text = "#include <collide/karabassi_swept.hpp>\n" + text
    return text + f"COLLIDE_PYTHON_SIMULATION({', '.join([f'collide::{space}', scalar, narrow, *types])})\n"


def name_of(text):
    """The name of the file that a compiled source is in."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


if __name__ == "__main__":  # FOLDER SPACE SUFFIX COUNT: writes the first lists of the package, and prints the files
    import pathlib
    import sys

    for names in BUILT_IN[: int(sys.argv[4])]:
        text = source(names.split(), sys.argv[2])
        path = pathlib.Path(sys.argv[1]) / (name_of(text) + sys.argv[3])
        if not path.exists() or path.read_text() != text:
            path.write_text(text)
        print(path)
