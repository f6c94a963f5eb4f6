"""Effects of a simulation: descriptions, of a name and parameters. docs/simulation.md says what each does.

The functions here are the table of effects: their arguments are the parameters, with the defaults of C++.
"""

import copy
import functools
import inspect
from typing import Any, Callable, Literal, Mapping, Sequence, TypeVar, get_args, get_origin

from ._errors import choice, real, refuse, shown

Vector = Sequence[float]  #: three numbers


class Effect:
    """What happens to particles in a step: an effect of your own. Those of the library are functions that make one.

    name        the name of the struct in C++
    parameters  its members of type double, or double[3]: numbers, or three of them
    code        C++ that defines the struct (docs/development/extending.md): ``Effect('spring', {'stiffness': 10.0}, code='struct spring
                {...};')``

    Raises TypeError or ValueError, which name the parameter, for what is no number.
    """

    def __init__(self, name: str, parameters: Mapping[str, Any] | None = None, code: str = "") -> None:
        refuse(not isinstance(name, str) or not name.isidentifier(), "name", f"expected that of a struct, got {shown(name)}")
        refuse(not isinstance(code, str), "code", f"expected C++, got {shown(code)}", TypeError)
        self.name, self.code = name, code
        self.parameters: dict[str, list[float]] = {key: _numbers(key, value) for key, value in (parameters or {}).items()}
        self._type, self._is_own = name, True  # in C++
        self._members = {key: f"e.{key}" for key in self.parameters}  # what sets each of them

    def __repr__(self):
        values = ", ".join(f"{k}={v[0] if len(v) == 1 else tuple(v)}" for k, v in self.parameters.items())
        return f"collide.{self.name}({values})"

    def _lines(self):
        """The code; errors in that of a user say where."""
        kind = type(self).__name__.lower()
        return f'#line 1 "{kind} {self.name}"\n{self.code}\n#line 1 "simulation"' if self._is_own else self.code

    def _take(self, part, law):
        """Gives it the parameters of a law, which is a member in C++."""
        for key, values in law.parameters.items():
            self.parameters[f"{part}_{key}"] = values
            self._members[f"{part}_{key}"] = law._members[key].replace("e.", f"e.{part}.", 1)

    def _changed(self, parameters):
        """The same with other values of some parameters."""
        for unknown in parameters.keys() - self.parameters.keys():
            refuse(True, unknown, f"{self.name} has no such parameter; it has {', '.join(self.parameters) or 'none'}")
        changed = copy.copy(self)
        new = {key: _numbers(key, value, len(self.parameters[key])) for key, value in parameters.items()}
        changed.parameters = {**self.parameters, **new}
        return changed


class Law(Effect):
    """A law of `collide.granular_contact`: one of `collide.granular`, or one of your own, with name, parameters and code
    as for `Effect`."""

    _part = ""  # which it may be; that of the user any


def _numbers(name, value, size=None) -> list[float]:
    try:
        listed = [value] if isinstance(value, (str, bytes)) else list(value)
    except Exception:  # noqa: BLE001: of a class of the user
        listed = [value]
    try:
        numbers = [real(name, v) for v in listed]
    except TypeError:
        raise TypeError(f"{name}: expected numbers, got {shown(value)}") from None
    wrong = size is not None and len(numbers) != size
    refuse(wrong, name, f"expected {'a number' if size == 1 else f'{size} numbers'}, got {shown(value)}")
    return numbers


def _values(name, value, annotation):
    """An argument of a function that describes an effect, as numbers; a word of a Literal is its place there."""
    if get_origin(annotation) is Literal:
        value = get_args(annotation).index(choice(name, value, get_args(annotation)))
    return _numbers(name, value, 3 if annotation is Vector else 1)


Function = TypeVar("Function", bound=Callable[..., Any])


def _describes(kind, header="", type="", memory="", part="", **members) -> Callable[[Function], Function]:
    """Makes a function that describes an effect: the name and the parameters are the function's own, and what it returns,
    if anything, are other values of some. ``type`` and ``members`` are names in C++, where they differ; ``memory`` is the
    header of what the effect has beside its parameters, ``part`` which law it may be."""

    def decorate(function):
        name, arguments = function.__name__.lstrip('_'), inspect.signature(function)

        @functools.wraps(function)
        def make(*positional, **named):
            given = arguments.bind(*positional, **named)
            given.apply_defaults()
            values = {**given.arguments, **(function(*positional, **named) or {})}
            made = kind(name, {}, f"#include <collide/{header or 'effects/' + name}.hpp>")
            made.code += f'\n#include "{memory}"' if memory else ""
            made.parameters = {key: _values(key, x, arguments.parameters[key].annotation) for key, x in values.items()}
            made._type, made._is_own, made._part = "collide::" + (type or name), False, part
            made._members = {key: "e." + members.get(key, key) for key in values}
            return made

        return make

    return decorate


@_describes(Effect)
def gravity(x: float = 0, y: float = 0, z: float = -9.81) -> Effect:
    """Constant acceleration, in length per time squared."""


@_describes(Effect)
def drag(linear: float = 0, quadratic: float = 0) -> Effect:
    """A medium at rest slows particles: ``linear`` per time, ``quadratic`` per length; not negative."""


@_describes(Effect, type="external_forces<>", density="made_of.density")
def external_forces(density: float = 1) -> Effect:
    """Forces (mass times length per time squared) that you write between steps: the column external_force. ``density`` is
    mass per volume."""


@_describes(Effect, type="wind<>", x="field.x", y="field.y", z="field.z")
def wind(x: float = 0, y: float = 0, z: float = 0, linear: float = 0, quadratic: float = 0) -> Effect:
    """Drag in a medium that moves with the velocity x, y, z (length per time)."""


@_describes(Effect)
def bounce(restitution: float = 0.5) -> Effect:
    """The mesh repels particles; speed after a bounce over speed before it, 0 to 1."""


@_describes(Effect)
def friction(static_coefficient: float = 0.5, kinetic_coefficient: float | None = None) -> Effect:
    """Coulomb friction at the mesh; after `bounce`. The kinetic coefficient is not above the static one, and is it if it
    is not given."""
    return {"kinetic_coefficient": static_coefficient} if kinetic_coefficient is None else None


@_describes(Effect)
def spin(rolling_resistance: float = 0) -> Effect:
    """Particles rotate, and friction makes them roll. Adds the column angular_velocity (radians per time)."""


@_describes(Effect)
def adhesion(max_acceleration: float = 20, capture_speed: float = float("inf")) -> Effect:
    """What touches the mesh no faster than ``capture_speed`` stays until an acceleration pulls it off; after `bounce`."""


@_describes(Effect)
def sphere_contact(stiffness: float = 1000, damping: float = 0, friction: float = 0, tangential_damping: float = 0,
                   density: float = 1) -> Effect:
    """Particles that overlap repel each other: a spring (mass per time squared) and dashpots (mass per time)."""


@_describes(Effect)
def sleep(speed: float = 0.01, steps: int = 50) -> Effect:
    """What has been slower than ``speed`` for so many steps (1 to 127) is skipped until it is hit."""


@_describes(
    Effect, position="source.position", half_width="source.half_width", velocity="source.velocity",
    velocity_spread="source.velocity_spread",
)
def emit(rate: float, position: Vector, velocity: Vector = (0, 0, 0), half_width: float = 0, velocity_spread: float = 0,
         radius: float = 0, only_where_free: bool = False) -> Effect:
    """A source: ``rate`` particles per time from a cube around ``position``, into the places that `Simulation.set` was
    given as capacity. With `polydisperse` they have ``radius``. ``only_where_free``: none is put where another one is."""


@_describes(Effect)
def absorb() -> Effect:
    """Particles vanish at the mesh."""


@_describes(Effect, "effects/absorb")
def absorbing_box(lower: Vector, upper: Vector) -> Effect:
    """Particles vanish in a box."""


@_describes(Effect, "effects/bounds")
def box_walls(lower: Vector, upper: Vector, restitution: float = 0.5) -> Effect:
    """Walls of a box, without a mesh; infinite bounds are no walls."""


@_describes(Effect, "effects/bounds")
def periodic_box(lower: Vector, upper: Vector) -> Effect:
    """A box that repeats: each coordinate is modulo its length. Particles meet across its sides."""


@_describes(Effect)
def clumps() -> Effect:
    """Spheres move in rigid groups, placed by `Simulation.set_clumps`; with `velocity_verlet` and contact by forces."""


@_describes(Effect)
def polydisperse() -> Effect:
    """Each particle has its own radius: the column radius."""


@_describes(Effect)
def lost() -> Effect:
    """Marks particles whose position or velocity is NaN or infinite: the column is_lost."""


@_describes(Effect)
def lost_motion() -> Effect:
    """Counts steps whose displacement is lost to rounding: the column lost_steps."""


@_describes(Effect, "effects/contact_forces")
def mesh_forces(density: float = 1) -> Effect:
    """Forces of the mesh on each particle: the column mesh_force."""


@_describes(Effect, "effects/contact_forces")
def pair_forces(density: float = 1) -> Effect:
    """Forces of other particles on each particle, after the effects that make them: the column pair_force."""


@_describes(Effect, "effects/mass_flow", type="mass_flow<>", density="made_of.density", memory="sums.hpp")
def mass_flow(point: Vector, normal: Vector, unit: float, density: float = 1, disc: float = float("inf")) -> Effect:
    """Counts what goes through the plane through ``point`` across ``normal``, or a disc of it with that radius, forwards
    minus backwards: `Simulation.sums`. ``unit``: mass that each particle's is rounded to; ``density``: mass per volume."""


@_describes(Effect, "effects/wear", type="wear<>", density="made_of.density", memory="sums.hpp")
def wear(unit_of_impulse: float, unit_of_work: float, density: float = 1) -> Effect:
    """Sums up the impulse along normals that `granular_contact`, before it in the list, gives to each triangle, and the
    work of friction there: `Simulation.sums`. Each contact is rounded to the units; ``density``: mass per volume."""


@_describes(Effect, type="contact_work<>", density="made_of.density")
def contact_work(density: float = 1, arm_shortening: float = 0.5) -> Effect:
    """Sums up the work of contacts of `granular_contact` or `sphere_contact`, before it in the list: `Simulation.energy` has
    what was lost, and given by walls. ``density``: mass per volume; ``arm_shortening`` as of `granular_contact`."""


@_describes(Effect, memory="sums.hpp")
def reaction(unit: float, density: float = 1, triangles: bool = False) -> Effect:
    """Sums up what particles give to bodies and to what rests, and to each triangle if asked:
    `Simulation.sums`. ``unit``: impulse (force times time) that each contact is rounded to; ``density``: mass per volume."""


@_describes(Effect, "effects/bodies", type="moving_bodies<>")
def moving_bodies() -> Effect:
    """Parts of the mesh move: see `Body`."""


@_describes(Effect, "effects/bodies", type="moving_bodies<collide::driven>")
def driven_bodies() -> Effect:
    """Parts of the mesh move as `Simulation.drive` says before each step."""


@_describes(Effect, "effects/integrators")
def velocity_verlet() -> Effect:
    """The integrator of second order; without it semi-implicit Euler, of first."""


__all__ = [  # all functions above, as words for type checkers
    "gravity", "drag", "external_forces", "wind", "bounce", "friction", "spin", "adhesion", "sphere_contact",
    "sleep", "emit", "absorb", "absorbing_box", "box_walls", "periodic_box", "clumps", "polydisperse", "lost", "lost_motion",
    "mesh_forces", "pair_forces", "mass_flow", "reaction", "wear", "contact_work", "moving_bodies", "driven_bodies",
    "velocity_verlet",
]
