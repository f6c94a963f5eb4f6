"""Particles that move, and collide with a mesh and with each other."""

import dataclasses
import functools
import os
import pathlib
import tempfile
from typing import Any, Callable, Iterable, Literal, NamedTuple, overload

import numpy

from . import _build
from ._arrays import CUDA, library_of, module_for, of_list, stream_of, table
from ._mesh import PRECISIONS, Array, Mesh, Precision, how_many_threads
from ._clumps import ClumpShape
from ._errors import choice, real, refuse, shown, whole
from .effects import Effect, Vector, _numbers
from .granular import count_of


@dataclasses.dataclass
class Body:
    """Triangles of the mesh that move as a whole: ``size`` of them from number ``first`` on.

    At time t, with s = sin(2 pi (frequency t + phase)), the pivot is at pivot + velocity t + amplitude s, and the body is
    turned around ``axis`` through it by the angle rate t + swing s, in radians. ``belt`` is the velocity of the surface of
    a belt that stays where it is. At most 64 bodies; the simulation's list has `moving_bodies`, or `driven_bodies`: then
    only ``first``, ``size``, ``pivot`` and ``axis`` count, and `Simulation.drive` moves them.
    """

    first: int
    size: int
    pivot: Vector = (0, 0, 0)
    velocity: Vector = (0, 0, 0)
    axis: Vector = (0, 0, 1)
    rate: float = 0
    amplitude: Vector = (0, 0, 0)
    swing: float = 0
    frequency: float = 0
    phase: float = 0
    belt: Vector = (0, 0, 0)

    def __post_init__(self) -> None:
        self._numbers()

    def _state(self, angle=0.0, rate=0.0, shift=(0, 0, 0), velocity=(0, 0, 0), belt=(0, 0, 0)):
        """The 16 numbers of a body_state: the body turned around its axis through the pivot, and shifted."""
        axis = numpy.array(_numbers("axis", self.axis, 3))
        length = numpy.linalg.norm(axis)
        axis = axis / length if length > 0 else axis
        pivot, half = numpy.array(_numbers("pivot", self.pivot, 3)), real("angle", angle) / 2
        turned = axis * (axis @ pivot) + numpy.cos(2 * half) * (pivot - axis * (axis @ pivot)) + numpy.sin(2 * half) * numpy.cross(axis, pivot)
        angular = axis * real("rate", rate)
        linear = _numbers("velocity", velocity, 3) - numpy.cross(angular, turned)
        position = pivot - turned + _numbers("shift", shift, 3)
        return [*position, numpy.cos(half), *(numpy.sin(half) * axis), *linear, *angular, *_numbers("belt", belt, 3)]

    def _numbers(self):
        numbers = [float(whole(name, getattr(self, name))) for name in ("first", "size")]
        for field in dataclasses.fields(self)[2:]:
            numbers += _numbers(field.name, getattr(self, field.name), 3 if isinstance(field.default, tuple) else 1)
        return numbers


class Impulses(NamedTuple):
    """What particles have given, on the host: rows are those of each body, of all that rests, and, with ``triangles``, of
    each triangle."""

    linear: numpy.ndarray  #: (rows, 3) float64: force times time
    angular: numpy.ndarray  #: (rows, 3): its moment about the origin; about a point x it is angular - cross(x, linear)
    bodies: int  #: rows below are bodies', this one is that of what rests, those behind it are triangles'
    refused: int  #: contacts that are in no sum: what they gave is not finite, or 2e18 units or more


class ContactReport(NamedTuple):
    """How many contacts there are between particles, and how deep: look at it when a scene is new."""

    contacts: int  #: pairs that overlap
    coordination: float  #: contacts of a particle, the mean
    deep: int  #: contacts whose overlap is above a fifth of the smaller radius: too soft
    largest_overlap: float  #: over the smaller radius


class Births(NamedTuple):
    """What a source has made since `Simulation.set`."""

    due: int  #: particles that have come due: time times rate
    overlapping: int  #: of these, those that overlapped another one
    not_born: int  #: with ``only_where_free`` those, and those whose place was taken


class Flow(NamedTuple):
    """What went through the surface of `mass_flow`, forwards minus backwards."""

    particles: int
    mass: float


class Loads(NamedTuple):
    """What `wear` has summed up of each triangle, on the host."""

    normal_impulse: numpy.ndarray  #: (triangles,) float64: over area and time the mean pressure
    sliding_work: numpy.ndarray  #: (triangles,): work of friction


class Simulation:
    """Particles that do what a list of effects says, in its order.

        sim = collide.Simulation(mesh, [collide.gravity(0, 0, -9.81), collide.bounce(0.5)])
        sim.set(centres, radius, velocities)
        sim.steps(1000, 1e-3)
        sim["velocity"]

    mesh       what particles touch, and where it runs: host or GPU, float32 or float64
    effects    of `collide.effects`, or `Effect`s of your own
    bodies     parts of the mesh that move, with `moving_bodies` or `driven_bodies` in the list
    swept      particles pass through nothing, however fast: several times a step's cost
    precision  of contacts with the mesh, as for `Mesh.query`
    threads    on the host, as for `Mesh`

    A list that is not in the package is compiled by g++, or nvcc, when it is first used, in three seconds, or nine with
    `granular_contact`, and again when `energy`, `contact_report`, `save` or `load` is first called; it is kept in
    COLLIDE_CACHE, else $XDG_CACHE_HOME/collide, else ~/.cache/collide. Raises `Error` without a compiler, or where
    effects do not fit together. Units are those of the scene. The same steps give the same bits on every run, and on host and GPU.

    Pickle and copy.deepcopy copy the mesh, particles and parameters, as `save` does; `sums` begin anew.
    """

    def __init__(self, mesh: Mesh, effects: Iterable[Effect], *, bodies: Iterable[Body] = (), swept: bool = False,
                 precision: Precision = "exact", threads: int = 0) -> None:
        _check_mesh(mesh)
        self.effects = _listed("effects", effects, Effect, "collide.gravity()")
        names = [effect.name for effect in self.effects]
        twice = next((name for name in names if names.count(name) > 1), "")
        refuse(twice, "effects", f"{twice} is in the list more than once")
        self._mesh, self._bodies = mesh, _listed("bodies", bodies, Body, "collide.Body(0, 2)")
        self._device, self._library, self._threads = mesh._device, mesh._library, how_many_threads(threads)
        self._options = {"swept": bool(swept), "precision": choice("precision", precision, PRECISIONS)}
        self._path, self._bookkeeping = self._library_for("simulation"), None
        self._simulation, self._is_set = self._made(), False

    def _library_for(self, part):
        """The path of a compiled part of the list."""
        on_gpu = self._device[0] == CUDA
        capability = module_for(self._device, "mesh").capability(self._device[1]) if on_gpu else None
        scalar = "double" if self._mesh._is_wide else "float"
        return _build.library(part, self.effects, "cuda_shared" if on_gpu else "host", capability, scalar=scalar, **self._options)

    def _with_bookkeeping(self):
        """The compiled simulation with energy, contact_report, save and load, compiled when one is first called."""
        if self._bookkeeping is None:
            path = self._library_for("bookkeeping")
            self._simulation.take_bookkeeping(self._stream(), path)
            self._bookkeeping = path
        return self._simulation

    def _made(self):
        """The compiled simulation, with mesh and parameters."""
        module = module_for(self._device, "mesh")
        kind = module.SimulationDouble if self._mesh._is_wide else module.SimulationFloat
        made = kind(self._path, self._threads, self._device[1])
        if self._bookkeeping is not None:
            made.take_bookkeeping(self._stream(), self._bookkeeping)
        self._give_mesh(made, self._mesh, self._bodies)
        for number, effect in enumerate(self.effects):
            for name, values in effect.parameters.items():
                self._set_parameter(made, number, name, values)
        return made

    def _set_parameter(self, simulation, number, name, values):
        done = simulation.set_parameter(self._stream(), number, name, values)
        refuse(not done, name, "there is no such parameter of so many numbers")

    def _give_mesh(self, simulation, mesh, bodies):
        version = mesh._version  # before its arrays are taken
        simulation.set_mesh(self._stream(), mesh._mesh, [body._numbers() for body in bodies])
        self._mesh, self._bodies, self._version = mesh, bodies, version
        self._states = [body._state() for body in bodies]

    def _replace(self, function, *arguments):
        """Calls a function of the compiled simulation that replaces all particles, or of another one where arrays show its
        columns, which then stay as they are."""
        simulation = self._simulation
        while not getattr(simulation, function)(self._stream(), *arguments):
            simulation = self._made()
        self._simulation, self._is_set = simulation, True

    def __reduce__(self):
        state = None
        if self._is_set:
            with tempfile.TemporaryDirectory() as folder:
                path = pathlib.Path(folder, "state")
                self.save(path)
                state = path.read_bytes()
        make = functools.partial(Simulation, bodies=self._bodies, threads=self._threads, **self._options)
        return make, (self._mesh, self.effects), state

    def __setstate__(self, state):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "state")
            path.write_bytes(state)
            self.load(path)

    def set_mesh(self, mesh: Mesh | None = None, bodies: Iterable[Body] | None = None) -> None:
        """Gives another mesh, or other bodies. After `Mesh.update` the next step calls it. O(triangles)."""
        mesh = self._mesh if mesh is None else _check_mesh(mesh)
        wrong = (mesh._device, mesh._is_wide) != (self._device, self._mesh._is_wide)
        refuse(wrong, "mesh", "has another device or dtype than the simulation's")
        listed = self._bodies if bodies is None else _listed("bodies", bodies, Body, "collide.Body(0, 2)")
        self._give_mesh(self._simulation, mesh, listed)

    def set(self, centres: Array, radius: float | Array, velocities: Array | None = None, *, capacity: int = 0) -> None:
        """Copies particles: those of before are gone, and the time is 0.

        centres     (n, 3) of the mesh's dtype and device
        radius      a number, or with `polydisperse` in the list (n,); not negative
        velocities  (n, 3), packed; None: at rest
        capacity    for how many there is room, if an effect makes some

        On the host short lists are taken, too.
        """
        dtype = self._mesh._dtype
        centres, radius = of_list(centres, "centres", dtype), of_list(radius, "radius", dtype)
        velocities = of_list(velocities, "velocities", dtype)
        self._library = library_of(centres, self._device)
        self._replace("set", centres, radius, velocities, whole("capacity", capacity, 0, 2**32 - 2))

    def set_clumps(self, shapes: ClumpShape | Iterable[ClumpShape], centres: Any, rotations: Any = (1, 0, 0, 0),
                   velocities: Any = (0, 0, 0), angular_velocities: Any = (0, 0, 0), *, shape: Any = 0, scale: Any = 1,
                   waiting: int = 0) -> None:
        """Puts n clumps in place of all particles, with `clumps` in the list: those of before are gone, and the time is 0.
        The columns have a row for each sphere, those of a clump one after the other; ``clump_rotation`` and others of a
        clump are in its first row. Radii that differ need `polydisperse`.

        shapes              a `ClumpShape`, or several; one of a single sphere is a grain by itself
        centres             (n, 3): the centres of mass; numbers, as all arguments, on the host
        rotations           (n, 4) or one: unit quaternions w, x, y, z of the frames in which spheres were given
        velocities          (n, 3) or one: of the centres of mass
        angular_velocities  (n, 3) or one: radians per time
        shape               (n,) or one: which of ``shapes``
        scale               (n,) or one: by how much larger than their shapes they are, above 0
        waiting             so many of the last are not there: `emit` makes them; each has as many spheres
        """
        shapes = _listed("shapes", shapes, ClumpShape, "collide.ClumpShape(centres, radii)")
        x = table("centres", centres, "n", 3)
        parts = [table(name, values, len(x), width) for name, values, width in (
            ("shape", shape, 1), ("centres", x, 3), ("rotations", rotations, 4), ("velocities", velocities, 3),
            ("angular_velocities", angular_velocities, 3), ("scale", scale, 1))]
        wrong = not numpy.isin(parts[0], numpy.arange(len(shapes))).all()
        refuse(wrong, "shape", f"expected whole numbers from 0 to {len(shapes) - 1}")
        self._replace("set_clumps", [n for s in shapes for n in s._numbers], numpy.hstack(parts).ravel().tolist(),
                      whole("waiting", waiting, 0, len(x)))

    def step(self, dt: float) -> None:
        """Advances by the time dt, above 0."""
        self.steps(1, dt)

    def steps(self, n: int, dt: float, *, call: Callable[[int], Any] | None = None, every: int | None = None) -> None:
        """Advances n times by dt. On a GPU it does not wait. Ctrl-C ends it between two steps; `time` says which.

        call   is called with the number of steps done, after ``every`` so many (a hundredth of n), and at the end: to show
               progress, or to write files
        """
        n, dt = whole("n", n, 0, 2**63 - 1), real("dt", dt)
        refuse(call is not None and not callable(call), "call", f"expected a function, got {shown(call)}", TypeError)
        refuse(every is not None and call is None, "every", "is for a function to call")
        share = whole("every", every if every is not None else max(1, n // 100), 1, 2**63 - 1)
        if self._version != self._mesh._version:
            self._give_mesh(self._simulation, self._mesh, self._bodies)
        done = 0
        while done < n:  # each call takes a tenth of a second, or a step
            end = min(n, done - done % share + share) if call is not None else n
            done += self._simulation.steps(self._stream(), end - done, dt)
            if call is not None and done == end:
                call(done)

    def drive(self, body: int, angle: float = 0, rate: float = 0, *, shift: Vector = (0, 0, 0),
              velocity: Vector = (0, 0, 0), belt: Vector = (0, 0, 0)) -> None:
        """Says where a body is at the end of the next step, and how it moves then, with `driven_bodies` in the list: a
        servo calls it before each step. A body that is not driven again stays there, and its surface goes on moving.

        body      its number
        angle     radians around ``axis`` through the pivot, from where it lies in memory; ``rate``: radians per time
        shift     of the pivot, from where it lies in memory; ``velocity``: of the pivot
        belt      velocity of the surface of a belt that stays where it is

        In the first step after `set` or `set_mesh` a body is all the time where it is said to be. Does not wait.
        """
        number = whole("body", body, 0, max(len(self._bodies) - 1, 0))
        refuse(not self._bodies, "body", "the simulation has none: give it bodies=[collide.Body(first, size)]")
        self._states[number] = self._bodies[number]._state(angle, rate, shift, velocity, belt)
        done = self._simulation.drive(self._stream(), [x for state in self._states for x in state])
        refuse(not done, "body", "bodies of this list move by themselves: name driven_bodies instead of moving_bodies")

    def __getitem__(self, name: str) -> Array:
        """A column of the particles: (n, 3) for ``position`` and ``velocity``, (n, 3) or (n,) for those of `columns`. It
        shows the simulation's own memory: it changes with steps, and may be written to between them. After `set` it shows
        the particles of before. Of jax, whose arrays never change, it is a copy."""
        stream = self._stream()
        column = self._simulation.column(stream, self._column(name), self._library.is_numpy)
        return self._library.shown(self._library.array(column, stream))

    def __setitem__(self, name: str, values: Array) -> None:
        """Gives all particles a column's values, packed and of its dtype."""
        solids = next((e.parameters["materials"] for e in self.effects if "materials" in e.parameters), [])
        if name == "material" and hasattr(values, "max") and len(values) != 0:
            most, count = int(values.max()), count_of(solids) or 256
            refuse(most >= count, "material", f"is {most}, and there are {count}, from 0")
        self._simulation.assign(self._stream(), self._column(name), values)

    def change(self, effect: int | str, **parameters: float | Vector) -> None:
        """Changes parameters of an effect, by its name or its place in the list: ``sim.change('gravity', z=-1.62)``."""
        number = self._number(effect)
        changed = self.effects[number]._changed(parameters)
        for name in parameters:
            self._set_parameter(self._simulation, number, name, changed.parameters[name])
        self.effects = (*self.effects[:number], changed, *self.effects[number + 1 :])

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return self._simulation.columns(self._stream())

    @property
    def time(self) -> float:
        """The sum of the steps since `set`."""
        return self._simulation.time(self._stream())

    def __len__(self) -> int:
        """How many particles there are, or places for them."""
        return self._simulation.size(self._stream())

    def largest_time_step(self) -> float:
        """A step that is good for springs between particles; infinite without any."""
        return self._simulation.largest_time_step(self._stream())

    def energy(self, density: float = 0) -> dict[str, float]:
        """Kinetic, rotational, elastic and potential energy, and that of tangential springs; with `contact_work`, also the
        work lost to damping, sliding and rolling, and that given by walls. ``density`` is mass per volume, 0 that of
        the effect by which particles meet. Waits; O(n), O(n log n) where particles meet."""
        density = real("density", density)
        of_all = self._with_bookkeeping().energy(self._stream(), density)
        names = "kinetic rotational elastic potential tangential damping sliding rolling given"
        return dict(zip(names.split(), of_all))

    def contacts(self) -> Array:
        """(n, 2) int32, sorted: pairs of particles that touch, the smaller number first. Exact; not across the sides of
        `periodic_box`. Of particles and the mesh `Mesh.contacts` has them. O(n + pairs)."""
        pairs = self._library.array(self._simulation.contacts(self._stream(), self._library.is_numpy), self._stream())
        if "alive" not in self:
            return pairs
        is_there = self["alive"] != 0
        return pairs[is_there[pairs[:, 0]] & is_there[pairs[:, 1]]]

    def contact_report(self) -> ContactReport:
        """How many contacts there are between particles, and how deep: `ContactReport`. Waits; O(n log n)."""
        found = self._with_bookkeeping().contact_report(self._stream())
        return ContactReport(int(found[0]), found[1], int(found[2]), found[3])

    @property
    def births(self) -> Births:
        """Counts of the list's source, such as `emit`: `Births`. Waits. Raises ValueError without one."""
        found = self._simulation.births(self._stream())
        refuse(not found, "births", "no effect of the list makes particles")
        return Births(*(int(x) for x in found))

    @overload
    def sums(self, effect: Literal["reaction"]) -> Impulses: ...
    @overload
    def sums(self, effect: Literal["mass_flow"]) -> Flow: ...
    @overload
    def sums(self, effect: Literal["wear"]) -> Loads: ...
    @overload
    def sums(self, effect: int | str) -> Impulses | Flow | Loads: ...

    def sums(self, effect: int | str) -> Impulses | Flow | Loads:
        """What `reaction`, `mass_flow` or `wear`, by its name or its place in the list, has summed up since `set`, `load`, `clear`,
        a change of its parameters, or of the numbers of bodies and triangles. Waits."""
        number = self._number(effect)
        found = self._simulation.sums(self._stream(), number)
        name = self.effects[number].name
        if name == "wear":
            return Loads(*numpy.reshape(found, (-1, 2)).T)
        refuse(not found, "effect", f"{name} has no sums; reaction, mass_flow and wear have")
        if len(found) == 2:
            return Flow(int(found[0]), found[1])
        parts = numpy.reshape(found[:-1], (-1, 2, 3))
        return Impulses(*numpy.swapaxes(parts, 0, 1), bodies=len(self._bodies), refused=int(found[-1]))

    def clear(self, effect: int | str) -> None:
        """Begins the sums of `reaction`, `mass_flow` or `wear` anew. Does not wait."""
        self._simulation.clear(self._stream(), self._number(effect))

    def save(self, path: str | os.PathLike) -> None:
        """Writes particles and parameters to a file; not the mesh."""
        path = _path(path)
        self._with_bookkeeping().save(self._stream(), path)

    def load(self, path: str | os.PathLike) -> None:
        """Goes on where `save` was called, by a simulation of the same list: the same bits as without a break."""
        path = _path(path)
        self._with_bookkeeping()
        self._replace("load", path)

    def __repr__(self):
        return f"<collide.Simulation: {len(self)} particles, {', '.join(e.name for e in self.effects)}>"

    def __contains__(self, name: str) -> bool:
        """Whether there is a column of a name."""
        return name in self.columns

    def _column(self, name):
        names = self.columns
        if name not in names:
            raise KeyError(f"there is no column {shown(name)} in this simulation; there are {', '.join(names)}")
        return names.index(name)

    def _number(self, effect):
        names = [e.name for e in self.effects]
        if isinstance(effect, str) and effect in names:
            return names.index(effect)
        wrong = not isinstance(effect, int) or effect not in range(len(names))
        refuse(wrong, "effect", f"there is no {shown(effect)} in the list {', '.join(names)}")
        return effect

    def _stream(self) -> tuple[int, int]:
        return stream_of(self._library, self._device)


def _check_mesh(mesh):
    refuse(not isinstance(mesh, Mesh), "mesh", f"expected a collide.Mesh, got {shown(mesh)}", TypeError)
    return mesh


def _listed(name, values, kind, example):
    """A tuple of objects of a kind, from what may be iterated once."""
    try:
        listed = tuple(values)
    except TypeError:
        listed = (values,)
    for value in listed:
        refuse(not isinstance(value, kind), name, f"expected {name} such as {example}, got {shown(value)}", TypeError)
    return listed


def _path(path):
    """The name of a file, as text."""
    refuse(not isinstance(path, (str, bytes, os.PathLike)), "path", f"expected one, got {shown(path)}", TypeError)
    name = os.fsdecode(path)
    refuse("\0" in name, "path", "has a null character")
    return name
