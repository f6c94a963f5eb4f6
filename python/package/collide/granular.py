"""Laws and materials of `collide.granular_contact`. docs/granular.md says what each does, and where it is from.

    grains = collide.granular_contact(granular.hertz(), granular.mindlin(), granular.epsd(),
                                      materials=granular.materials(granular.Solid(1e7, 0.2, 2500),
                                                                   granular.SurfacePair(0.5, 0.5, 0.1)))
"""

import dataclasses
from typing import Literal, Mapping, Sequence

from ._errors import refuse, shown
from .effects import Effect, Law, _describes, _numbers

Damping = Literal["none", "of_tangent", "of_normal"]
Test = Literal["spring", "spring_and_dashpot"]
_EXAMPLES = {"normal": "hertz", "tangential": "mindlin", "rolling": "epsd", "cohesion": "sjkr"}


@_describes(Law, "effects/granular/linear", part="normal")
def linear(stiffness: float = 1000) -> Law:
    """Normal law: a spring of constant stiffness (force per overlap), and the dashpot that gives the restitution."""


@_describes(Law, "effects/granular/hertz", part="normal")
def hertz() -> Law:
    """Normal law: Hertz' force of elastic spheres, and the dashpot that gives the restitution."""


@_describes(Law, "effects/granular/law")
def none() -> Law:
    """In place of a tangential or rolling law, or one of cohesion: there is none."""


@_describes(Law, "effects/granular/dashpot", part="tangential")
def dashpot(damping: float = 0) -> Law:
    """Tangential law: a dashpot (force per slip) up to Coulomb's limit. Remembers nothing; a pile creeps."""


@_describes(Law, "effects/granular/cundall_strack", part="tangential")
def cundall_strack(stiffness_ratio: float = 2 / 7, damping_ratio: float = 0.5, test: Test = "spring_and_dashpot",
                   keeps_length: bool = False, turns_about_normal: bool = False) -> Law:
    """Tangential law: a spring that remembers slip and a dashpot, parts of the normal ones, up to Coulomb's limit: with
    `linear` LAMMPS' gran/hooke/history. The other arguments are those of `mindlin`."""


@_describes(Law, "effects/granular/mindlin", part="tangential")
def mindlin(stiffness_factor: float = 1, damping: Damping = "of_tangent", test: Test = "spring", keeps_length: bool = False,
            turns_about_normal: bool = False) -> Law:
    """Tangential law, with `hertz`: a spring that remembers slip, after Mindlin, up to Coulomb's limit.

    damping  of which spring the dashpot is: 'of_tangent', 'of_normal', or 'none'
    test     what is compared with the limit: 'spring' or 'spring_and_dashpot'
    keeps_length  the spring keeps its length where it turns with the contact
    turns_about_normal  the spring turns with the spins of the two about the normal, too
    """


@_describes(Law, "effects/granular/mindlin", part="tangential")
def mindlin_rescale(stiffness_factor: float = 1, damping: Damping = "of_tangent", test: Test = "spring",
                    keeps_length: bool = False, turns_about_normal: bool = False) -> Law:
    """`mindlin`, whose spring also becomes shorter where the area of contact does, as LAMMPS' of that name. Cycles of load
    and slip may make energy, as with `mindlin`."""


@_describes(Law, "effects/granular/mindlin", part="tangential")
def mindlin_force(stiffness_factor: float = 1, damping: Damping = "of_tangent", test: Test = "spring",
                  keeps_length: bool = False, turns_about_normal: bool = False, rescales: bool = True) -> Law:
    """`mindlin`, whose force a growing load leaves as it is, and a falling one reduces: no cycle of load and slip makes
    energy. Thornton, Cummins and Cleary, 2013; LAMMPS' mindlin_rescale/force.

    rescales  False: a falling load leaves the force as it is, too, and may make energy: LAMMPS' mindlin/force
    """


@_describes(Law, "effects/granular/rolling", part="rolling")
def constant_torque() -> Law:
    """Rolling law: a torque of constant size against what turns. What is nearly at rest trembles."""


@_describes(Law, "effects/granular/rolling", part="rolling")
def epsd(damping: float = 0.3, turns_about_normal: bool = False) -> Law:
    """Rolling law: a spring that remembers, and a dashpot, a ratio to critical damping. Piles stand still."""


@_describes(Law, "effects/granular/rolling", part="rolling")
def epsd2(turns_about_normal: bool = False) -> Law:
    """Rolling law, with `hertz`: `epsd` without the dashpot, and with the stiffness of `mindlin`'s spring."""


def _law(part, law):
    """A law that may be this part of granular contact; `none` in place of None."""
    law = none() if law is None else law
    expected = f"expected a law such as collide.granular.{_EXAMPLES[part]}(), got {shown(law)}"
    refuse(not isinstance(law, Law), part, expected, TypeError)
    wrong = law._part not in ("", part) or (law.name, part) == ("none", "normal")
    refuse(wrong, part, f"{law.name} is no law of this part" + (f", but of {law._part}" if law._part else ""))
    return law


def _beside(rolling, law):
    """A law of torsion, beside one of rolling."""
    rolling = _law("rolling", rolling)
    law.code = "\n".join([rolling._lines(), law.code])
    law._type = f"collide::{law.name}<{rolling._type}>"
    law._take("rolling", rolling)
    return law


@_describes(Law, "effects/granular/torsion", part="rolling")
def _marshall(stiffness_ratio: float, damping_ratio: float) -> Law: ...


@_describes(Law, "effects/granular/torsion", part="rolling")
def _torsion(stiffness: float, damping: float, friction: float) -> Law: ...


def marshall(rolling: Law | None = None, stiffness_ratio: float = 0, damping_ratio: float = 1) -> Law:
    """Rolling law: torsion, which is turning about the normal, beside a law of rolling. The surfaces stick by springs and
    dashpots, parts of the normal ones, up to 2/3 of the contact's radius times friction: Marshall 2009.

    rolling          a law of rolling, or None
    stiffness_ratio  of the tangential spring, over the normal one; 0: as of `mindlin`
    damping_ratio    of the tangential dashpot, over the normal one
    """
    return _beside(rolling, _marshall(stiffness_ratio, damping_ratio))


def torsion(rolling: Law | None = None, stiffness: float = 0, damping: float = 0, friction: float = 0) -> Law:
    """Rolling law: torsion beside a law of rolling: a spring (torque per angle), a dashpot (torque per angular velocity),
    and a limit (a length times the normal force)."""
    return _beside(rolling, _torsion(stiffness, damping, friction))


@_describes(Law, "effects/granular/cohesion", part="cohesion")
def sjkr(wall_factor: float = 0.5) -> Law:
    """Cohesion: a pull of the surfaces' cohesion (energy per volume) times the area of overlap, 4 pi R* overlap; at walls
    wall_factor of it. Friction has the limits that it has without the pull."""


@_describes(Law, "effects/granular/cohesion", part="cohesion")
def dmt() -> Law:
    """Cohesion, with `hertz`: a constant pull of hard grains; cohesion is energy per area."""


@_describes(Law, "effects/granular/cohesion", part="cohesion")
def jkr() -> Law:
    """Cohesion, with `hertz`: soft grains that stick, also a little apart; cohesion is energy per area."""


@dataclasses.dataclass
class Solid:
    """An elastic solid: Young's modulus (force per area, above 0), Poisson's ratio (above -1, at most 0.5) and density
    (mass per volume, above 0)."""

    young: float = 1e7
    poisson: float = 0.3
    density: float = 1000


@dataclasses.dataclass
class SurfacePair:
    """What two solids do where they touch: the coefficients of restitution (above 0, at most 1), of sliding and of rolling
    friction, and cohesion, which are not negative."""

    restitution: float = 1
    friction: float = 0
    rolling_friction: float = 0
    cohesion: float = 0


def materials(solids: Solid | Sequence[Solid],
              pairs: SurfacePair | Mapping[tuple[int, int], SurfacePair]) -> list[float]:
    """The materials of particles and walls, as numbers: one solid, or up to 32, and what each pair of them does.

    solids  one, or several: particles then have the column ``material``, uint8, with the number of theirs
    pairs   what all do, or ``{(0, 0): ..., (0, 1): ..., (1, 1): ...}``

    Raises ValueError for a pair that is missing.
    """
    solids = [solids] if isinstance(solids, Solid) else list(solids)
    numbers = [number for solid in solids for number in _numbers("solids", dataclasses.astuple(solid), 3)]
    for i in range(len(solids)):
        for j in range(i + 1):
            pair = pairs if isinstance(pairs, SurfacePair) else pairs.get((i, j), pairs.get((j, i)))
            refuse(pair is None, "pairs", f"the pair ({j}, {i}) is missing")
            numbers += _numbers("pairs", dataclasses.astuple(pair), 4)
    return numbers


def count_of(numbers: Sequence[float]) -> int | None:
    """How many solids the numbers of `materials` are of; None if they are no such numbers."""
    return next((n for n in range(1, 33) if 3 * n + 2 * n * (n + 1) == len(numbers)), None)


def granular_contact(normal: Law, tangential: Law | None = None, rolling: Law | None = None,
                     cohesion: Law | None = None, *, materials: Sequence[float] = materials(Solid(), SurfacePair()),
                     wall_material: int = 0, arm_shortening: float = 0.5, slip_shortening: float = 0.5) -> Effect:
    """Granular contact between particles, which are solid, and of particles with the mesh, which is solid then. Use float64
    and `velocity_verlet`; no `bounce`, `friction`, `adhesion` or `spin` beside it.

    normal, tangential, rolling, cohesion  laws of `collide.granular`. With a tangential or a rolling one particles turn.
    materials       `granular.materials(...)`
    wall_material   the number of the mesh's solid, where there are several
    arm_shortening  torques have the arm radius - arm_shortening overlap
    slip_shortening  slip is that of the surface at radius - slip_shortening overlap, from 0 to 1

    Parameters of a law are those of the effect with the word before them: ``sim.change('granular_contact',
    normal_stiffness=2000)``. `Simulation.largest_time_step` says how long a step may be.
    """
    laws = {"normal": normal, "tangential": tangential, "rolling": rolling, "cohesion": cohesion}
    laws = {part: _law(part, law) for part, law in laws.items()}
    count = count_of(materials)
    refuse(count is None, "materials", "expected what collide.granular.materials makes of 1 to 32 solids")
    arms = {"arm_shortening": arm_shortening, "slip_shortening": slip_shortening}
    made = Effect("granular_contact", {"materials": materials, **arms})
    solids = "collide::one_material" if count == 1 else f"collide::materials<{count}>"
    setter = "collide_python::set_materials(e.made_of, v)"
    made._members["materials"] = f"{len(materials)}, [&](double const* v) {{ {setter}; }}"
    if count != 1:
        made.parameters["wall_material"] = _numbers("wall_material", wall_material, 1)
        made._members["wall_material"] = "e.made_of.wall_material"
    for part, law in laws.items():
        made._take(part, law)
    codes = ["#include <collide/effects/granular_contact.hpp>", *(law._lines() for law in laws.values())]
    made.code = "\n".join(dict.fromkeys([*codes, '#include "granular_materials.hpp"']))
    made._is_own = False
    made._type = f"collide::granular_contact<{', '.join([*(law._type for law in laws.values()), solids])}>"
    return made
