"""Lists of effects as C++: the source of a simulation, and the lists that the package has compiled."""

import hashlib
import pathlib

from . import granular
from .effects import bounce, emit, friction, gravity, moving_bodies, polydisperse, sphere_contact, spin, velocity_verlet

_CONTACTS = [gravity(), sphere_contact(), bounce(), friction()]
_GRAINS = granular.granular_contact(granular.hertz(), granular.mindlin(), granular.epsd())
#: The lists that are compiled in the package, exact, with karabassi; float32, those with granular contact float64.
BUILT_IN = [
    [gravity()],
    [gravity(), bounce()],
    [gravity(), bounce(), friction()],
    [gravity(), bounce(), friction(), spin()],
    _CONTACTS[:2],
    _CONTACTS[:3],
    _CONTACTS,
    [emit(10, (0, 0, 1)), *_CONTACTS, spin()],
    [polydisperse(), *_CONTACTS],
    [*_CONTACTS, moving_bodies()],
    [gravity(), _GRAINS, velocity_verlet()],
    [gravity(), _GRAINS, moving_bodies(), velocity_verlet()],
]

_PRECISIONS = {"exact": "exact", "double": "double_precision", "single": "single_precision"}


def parameters_of(effects):
    """C++ that defines the effects, and ``parameters(effect, f)``, which calls f with the name and the member of each."""
    lines = ["#include <collide/effects/effect.hpp>", *dict.fromkeys(e._lines() for e in effects), "namespace collide_python {"]
    for e in {e._type: e for e in effects}.values():
        calls = " ".join(f'f("{name}", {member});' for name, member in e._members.items())
        unused = "" if calls else "[[maybe_unused]] "
        lines.append(f"template <class F> void parameters({unused}{e._type}& e, {unused}F const& f) {{ {calls} }}")
    return "\n".join([*lines, "}\n"])


PARTS = "simulation", "bookkeeping"  # what the package has in one library, and _build compiles one by one


def source(effects, space="host", scalar="float", precision="exact", swept=False, parts=PARTS):
    """C++ for parts of a list of effects."""
    swept = "_swept" if swept else ""
    narrow = f"collide::karabassi{swept}<collide::{_PRECISIONS[precision]}>"
    list_ = ", ".join([f"collide::{space}", scalar, narrow, *(e._type for e in effects)])
    exports = "".join(f'#include "{part}_of.hpp"\nCOLLIDE_PYTHON_{part.upper()}({list_})\n' for part in parts)
    return f"#include <collide/karabassi{swept}.hpp>\n{parameters_of(effects)}{exports}"


def name_of(text):
    """The name of the file that a compiled source is in."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def write(folder, space, suffix, count):
    """For CMake: writes the first lists of the package to a folder, and prints the files."""
    for effects in BUILT_IN[: int(count)]:
        text = source(effects, space, "double" if _GRAINS in effects else "float")
        path = pathlib.Path(folder) / (name_of(text) + suffix)
        if not path.exists() or path.read_text() != text:
            path.write_text(text)
        print(path)
