"""Effects of a simulation: descriptions, of a name and parameters. docs/simulation.md says what each does."""

from typing import Dict, Optional, Sequence, Tuple

from ._source import EFFECTS

__all__ = [*EFFECTS]

Vector = Tuple[float, float, float]


class Effect:
    """What happens to particles in a step: one of the library's effects by its name, or one of your own.

    name        'gravity', 'bounce', ...; of your own, the name of the struct in C++
    parameters  numbers, or three of them
    code        C++ that defines the struct (docs/effects.md): ``Effect('spring', {'stiffness': 10.0}, code='struct spring
                {...};')``. The parameters are its members of type double, or double[3].

    Raises ValueError for a name or a parameter that does not exist.
    """

    def __init__(self, name: str, parameters: Optional[Dict[str, object]] = None, code: Optional[str] = None):
        given = dict(parameters or {})
        self.name, self.code = name, code
        if code is None:
            if name not in EFFECTS:
                raise ValueError(f"effects: there is no effect {name!r}; there are {', '.join(EFFECTS)}")
            defaults = {parameter: default for parameter, default, _ in EFFECTS[name][2]}
            for unknown in given.keys() - defaults.keys():
                raise ValueError(f"{unknown}: {name} has no such parameter; it has {', '.join(defaults) or 'none'}")
            given = {**defaults, **given}
        self.parameters = {key: _numbers(key, value) for key, value in given.items()}
        if code is None:
            for key, numbers in self.parameters.items():
                if len(numbers) != len(_numbers(key, defaults[key])):
                    raise ValueError(f"{key}: of {name} is {'three numbers' if len(numbers) == 1 else 'one number'}")

    def __repr__(self):
        values = ", ".join(f"{k}={v[0] if len(v) == 1 else tuple(v)}" for k, v in self.parameters.items())
        return f"collide.{self.name}({values})"

    @property
    def _source(self):
        if self.code is None:
            return self.name
        return self.name, self.code, [(key, value, key) for key, value in self.parameters.items()]


def _numbers(name, value):
    try:
        numbers = [float(value)] if not isinstance(value, Sequence) else [float(v) for v in value]
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected a number or three, got {value!r}") from None
    if len(numbers) not in (1, 3):
        raise ValueError(f"{name}: expected a number or three, got {len(numbers)}")
    return numbers


def gravity(x: float = 0, y: float = 0, z: float = -9.81) -> Effect:
    """Constant acceleration, in length per time squared."""
    return Effect("gravity", {"x": x, "y": y, "z": z})


def drag(linear: float = 0, quadratic: float = 0) -> Effect:
    """A medium at rest slows particles: ``linear`` per time, ``quadratic`` per length; not negative."""
    return Effect("drag", {"linear": linear, "quadratic": quadratic})


def wind(x: float = 0, y: float = 0, z: float = 0, linear: float = 0, quadratic: float = 0) -> Effect:
    """Drag in a medium that moves with the velocity x, y, z (length per time)."""
    return Effect("wind", {"linear": linear, "quadratic": quadratic, "x": x, "y": y, "z": z})


def bounce(restitution: float = 0.5) -> Effect:
    """The mesh repels particles; speed after a bounce over speed before it, 0 to 1."""
    return Effect("bounce", {"restitution": restitution})


def friction(static_coefficient: float = 0.5, kinetic_coefficient: Optional[float] = None) -> Effect:
    """Coulomb friction at the mesh; after `bounce`. The kinetic coefficient is not above the static one, and is it if it
    is not given."""
    kinetic = static_coefficient if kinetic_coefficient is None else kinetic_coefficient
    return Effect("friction", {"static_coefficient": static_coefficient, "kinetic_coefficient": kinetic})


def spin(rolling_resistance: float = 0) -> Effect:
    """Particles rotate, and friction makes them roll. Adds the column angular_velocity (radians per time)."""
    return Effect("spin", {"rolling_resistance": rolling_resistance})


def adhesion(max_acceleration: float = 20, capture_speed: float = float("inf")) -> Effect:
    """What touches the mesh no faster than ``capture_speed`` stays until an acceleration pulls it off; after `bounce`."""
    return Effect("adhesion", {"max_acceleration": max_acceleration, "capture_speed": capture_speed})


def sphere_contact(
    stiffness: float = 1000, damping: float = 0, friction: float = 0, tangential_damping: float = 0, density: float = 1
) -> Effect:
    """Particles that overlap repel each other: a spring (mass per time squared) and dashpots (mass per time)."""
    return Effect(
        "sphere_contact",
        dict(
            stiffness=stiffness, damping=damping, friction=friction, tangential_damping=tangential_damping, density=density
        ),
    )


def sleep(speed: float = 0.01, steps: int = 50) -> Effect:
    """What has been slower than ``speed`` for so many steps (1 to 127) is skipped until it is hit."""
    return Effect("sleep", {"speed": speed, "steps": steps})


def emit(
    rate: float, position: Vector, velocity: Vector = (0, 0, 0), half_width: float = 0, velocity_spread: float = 0,
    radius: float = 0, only_where_free: bool = False,
) -> Effect:
    """A source: ``rate`` particles per time from a cube around ``position``, into the places that `Simulation.set` was
    given as capacity. With `polydisperse` they have ``radius``. ``only_where_free``: none is put where another one is."""
    return Effect(
        "emit",
        dict(
            rate=rate, radius=radius, position=position, half_width=half_width, velocity=velocity,
            velocity_spread=velocity_spread, only_where_free=only_where_free,
        ),
    )


def absorb() -> Effect:
    """Particles vanish at the mesh."""
    return Effect("absorb")


def absorbing_box(lower: Vector, upper: Vector) -> Effect:
    """Particles vanish in a box."""
    return Effect("absorbing_box", {"lower": lower, "upper": upper})


def box_walls(lower: Vector, upper: Vector, restitution: float = 0.5) -> Effect:
    """Walls of a box, without a mesh; infinite bounds are no walls."""
    return Effect("box_walls", {"lower": lower, "upper": upper, "restitution": restitution})


def periodic_box(lower: Vector, upper: Vector) -> Effect:
    """A box that repeats: each coordinate is modulo its length. Particles meet across its sides."""
    return Effect("periodic_box", {"lower": lower, "upper": upper})


def polydisperse() -> Effect:
    """Each particle has its own radius: the column radius."""
    return Effect("polydisperse")


def lost() -> Effect:
    """Marks particles whose position or velocity is NaN or infinite: the column is_lost."""
    return Effect("lost")


def lost_motion() -> Effect:
    """Counts steps whose displacement is lost to rounding: the column lost_steps."""
    return Effect("lost_motion")


def mesh_forces(density: float = 1) -> Effect:
    """Forces of the mesh on each particle, last in the list: the column mesh_force."""
    return Effect("mesh_forces", {"density": density})


def pair_forces(density: float = 1) -> Effect:
    """Forces of other particles on each particle, last in the list: the column pair_force."""
    return Effect("pair_forces", {"density": density})


def moving_bodies() -> Effect:
    """Parts of the mesh move: see `Body`."""
    return Effect("moving_bodies")


def velocity_verlet() -> Effect:
    """The integrator of second order; without it semi-implicit Euler, of first."""
    return Effect("velocity_verlet")
