"""Random calls with random arguments, until SECONDS have passed: `any_call.py SECONDS SEED LOG`.

Each example makes meshes and a simulation, and calls them with arguments that may be good or not, also while another
thread calls or writes to what is read, from a signal's handler, or in a forked process. Whatever it is, there is a result
of the right shape, or an error of one sentence that is ours; and at last the mesh has the right answers, which a few lines
of rational numbers give. What is called is written to LOG first. A call that takes a minute ends the process:
meshes are small, as next to coordinates of 1e300 everything takes exact arithmetic.
"""

import contextlib
import copy
import faulthandler
import fractions
import os
import pickle
import signal
import sys
import tempfile
import threading
import time
import traceback

import numpy
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from hypothesis.errors import Flaky

import collide

ALLOWED = (TypeError, ValueError, KeyError, MemoryError, collide.Error)
SQUARE = numpy.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
FACES = numpy.array([[0, 1, 2], [0, 2, 3]])
HUGE = [0, -0.0, 1, -1, 0.5, 1e-45, 1e-300, 1e300, -1e300, 3e38, float("inf"), -float("inf"), float("nan")]
WHOLE = [0, 1, -1, 2, 3, 7, 32, 33, 100, 2**31 - 1, 2**31, 2**32 - 1, 2**32, 2**61 + 1, 2**63, 2**64, -(2**63), 10**400]
ODD = [None, True, "", "text", b"bytes", (), [], {}, object(), numpy, numpy.ndarray, [[0, 0, 0]], numpy.float32(1), 1j, len]
INTEGERS = ["int32", "uint32", "int64", "uint64", "int16", "uint8"]
FLOATS = ["float32", "float64", "float16", "complex64", "bool", ">f4", "int32"]


in_use = []  #: the mesh that is called


class Exporter:
    """An array of an unknown library: __dlpack__ alone, and sometimes it fails."""

    def __init__(self, array, fails):
        self.array, self.fails = array, fails

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()

    def __dlpack__(self, **options):
        if self.fails:
            raise RuntimeError("not now")
        return self.array.__dlpack__(**options)


def often(data, usual, *unusual):
    """Mostly of the first strategy."""
    return data.draw(usual if data.draw(st.integers(0, 7)) else st.one_of(*unusual))


def laid_out(data, array):
    """The same numbers, elsewhere in memory."""
    n, width = array.shape
    kind = data.draw(st.sampled_from(["as it is", "fortran", "gaps", "backwards", "read-only", "unaligned", "one row", "exporter"]))
    if kind == "fortran":
        return numpy.asfortranarray(array)
    if kind == "gaps":
        wide = numpy.zeros((2 * n, width + 2), array.dtype)
        wide[::2, 1 : width + 1] = array
        return wide[::2, 1 : width + 1]
    if kind == "backwards":
        return array[::-1, ::-1]
    if kind == "read-only":
        array.flags.writeable = False
    if kind == "unaligned":
        room = numpy.zeros(array.nbytes + 1, numpy.uint8)[1:].view(array.dtype).reshape(array.shape)
        room[:] = array
        return room
    if kind == "one row" and n:
        return numpy.broadcast_to(array[:1], (data.draw(st.sampled_from([n, 1000])), width))
    return Exporter(array, data.draw(st.integers(0, 9)) == 0) if kind == "exporter" else array


def numbers(data, random, shape, dtype):
    array = numpy.array(random.normal(size=shape))
    for _ in range(data.draw(st.integers(0, 3)) if array.size else 0):
        array.flat[random.integers(0, array.size)] = data.draw(st.sampled_from(HUGE))
    with numpy.errstate(all="ignore"):
        return (array * data.draw(st.sampled_from([1, 1, 1, 0, 1e-30, 1e30]))).astype(dtype)


class Calls:
    """Draws arguments, and calls."""

    def __init__(self, data, log):
        self.data, self.log = data, log
        self.random = numpy.random.default_rng(data.draw(st.integers(0, 2**32)))
        self.dtype = data.draw(st.sampled_from(["float32", "float64"]))

    def points(self, n=None):
        n = n if n is not None else self.data.draw(st.sampled_from([0, 1, 2, 5, 40, 300]))
        shape = often(self.data, st.just((n, 3)), st.sampled_from([(n, 2), (n,), (3, n), (n, 3, 1), ()]))
        dtype = often(self.data, st.just(self.dtype), st.sampled_from(FLOATS))
        array = numbers(self.data, self.random, shape, dtype)
        array = laid_out(self.data, array) if array.ndim == 2 else array
        return often(self.data, st.just(array), st.sampled_from(ODD))

    def triangles(self, vertices):
        most = often(self.data, st.just(max(1, vertices)), st.sampled_from([2 * vertices + 1, 2**31 - 1, 2**15]))
        low = often(self.data, st.just(0), st.just(-5))
        array = self.random.integers(low, most, (self.data.draw(st.sampled_from([0, 1, 2, 30, 100])), 3))
        array = laid_out(self.data, array.astype(often(self.data, st.just("int32"), st.sampled_from(INTEGERS + FLOATS))))
        return often(self.data, st.just(array), st.none(), st.sampled_from(ODD))

    def whole(self, *usual):
        return often(self.data, st.sampled_from(usual), st.sampled_from(WHOLE), st.sampled_from(HUGE), st.sampled_from(ODD))

    def number(self, *usual):
        return often(self.data, st.sampled_from(usual), st.sampled_from(HUGE), st.sampled_from(WHOLE), st.sampled_from(ODD))

    def word(self, *usual):
        return often(self.data, st.sampled_from(usual), st.sampled_from(ODD))

    def radius(self, n):
        array = numpy.abs(numbers(self.data, self.random, (max(0, n),), self.dtype))
        return self.data.draw(st.sampled_from([array, array[::-1], self.number(0.1, 0.5)]))

    def out(self, n):
        width = self.data.draw(st.sampled_from([2, 10, 12, 13, 18, 20, 22, 24]))
        kind = self.data.draw(st.sampled_from([(n, width, "int32"), (n, width, "int32"), (n, 1, "uint8"), (n, width, "float32")]))
        array = numpy.zeros(kind[:2], kind[2])
        return often(self.data, st.none(), st.just(array if kind[1] > 1 else array[:, 0]), st.just(array[::2]), st.sampled_from(ODD))

    def mesh(self):
        n = self.data.draw(st.sampled_from([0, 3, 4, 6, 30, 300]))
        validate = self.word(True, True, False)
        return self.call(collide.Mesh, self.points(n), self.triangles(n), validate=validate, threads=self.whole(0, 0, 1, 2))

    def call(self, function, *arguments, **named):
        """What a call gives, or None after an error that may be."""
        self.log.seek(0)
        self.log.truncate()
        self.log.write(f"{getattr(function, '__qualname__', function)} {[describe(a) for a in (*arguments, *named.items())]}\n")
        self.log.flush()
        faulthandler.dump_traceback_later(60, exit=True)
        try:
            return function(*arguments, **named)
        except ALLOWED as error:
            text = str(error)
            assert "incompatible function arguments" not in text and "std::" not in text.replace("std::bad_alloc", ""), text
            assert isinstance(error, (MemoryError, KeyError)) or text.count("\n") == 0, text
        finally:
            faulthandler.cancel_dump_traceback_later()

    def query(self, mesh):
        x = self.points()
        n = len(x) if isinstance(x, numpy.ndarray) and x.ndim else 5
        precision, order = self.word("exact", "double", "single"), self.word("unspecified", "canonical")
        moves = often(self.data, st.none(), st.just(self.points(n)))
        what = self.data.draw(st.sampled_from("query csr any count contacts closest impacts first nearest k_nearest contains signed_distance distance".split()))
        capacity = often(self.data, st.none(), st.just(self.whole(0, 5, 1000)))
        if what in ("query", "csr", "contacts"):
            more = {"output": self.word(what if what == "csr" else "pairs")} if what != "contacts" else {}
            named = dict(displacements=moves, precision=precision, order=order, capacity=capacity, out=self.out(n), **more)
            found = self.call(getattr(mesh, "contacts" if what == "contacts" else "query"), x, self.radius(n), **named)
        elif what in ("any", "count"):
            more = {"out": self.out(n)} if what == "any" else {}
            found = self.call(getattr(mesh, what), x, self.radius(n), displacements=moves, precision=precision, **more)
        elif what == "closest":
            found = self.call(mesh.contacts, x, self.radius(n), closest=True, precision=precision)
        elif what in ("impacts", "first"):
            found = self.call(mesh.impacts, x, self.points(n), self.radius(n), first=what == "first", order=order, capacity=capacity)
        elif what == "contains":
            found = self.call(mesh.contains, x, out=self.out(n))
        else:
            k = (self.whole(1, 3, 32),) if what == "k_nearest" else ()
            found = self.call(getattr(mesh, what), x, *k, max_distance=self.number(float("inf"), 1.0), out=self.out(n))
        if found is not None and what in ("any", "closest", "first", "nearest", "k_nearest", "contains", "signed_distance", "distance"):
            assert len(found) == (n if isinstance(x, numpy.ndarray) else len(x if isinstance(x, list) else x.array))
        if found is not None and what not in ("count",) and self.data.draw(st.integers(0, 5)) == 0:
            self.call(pickle.dumps, found)

    def simulation(self, mesh):
        effects = self.data.draw(st.sampled_from(LISTS))
        effects = often(self.data, st.sampled_from([effects, iter(effects)]), st.sampled_from([None, 5, effects * 2, ["gravity"], effects[0]]))
        sim = self.call(collide.Simulation, self.word(mesh), effects, precision=self.word("exact"), threads=self.whole(0, 1))
        if sim is not None:
            x = self.points()
            self.call(sim.set, x, often(self.data, st.just(0.1), st.just(self.radius(5))), often(self.data, st.none(), st.just(self.points())), capacity=self.whole(0, 0, 10))
        return sim

    def step(self, sim, mesh):
        what = self.data.draw(st.sampled_from("steps steps steps set column assign write change energy mesh copy save load sums text".split()))
        names = self.call(lambda: sim.columns)
        if what == "steps":
            steps = self.whole(1, 5, 20)
            self.call(sim.steps, steps if not isinstance(steps, int) or steps < 10**6 else 5, self.number(1e-3, 1e-2, 1.0))
        elif what == "set":
            x = self.points()
            self.call(sim.set, x, self.radius(len(x) if isinstance(x, numpy.ndarray) and x.ndim else 1))
        elif what == "column":
            self.kept = self.call(sim.__getitem__, self.word(*names))  # looks at what other calls replace
        elif what == "assign":
            self.call(sim.__setitem__, self.word(*names), self.points(len(sim)))
        elif what == "write":
            view = self.call(sim.__getitem__, "position")
            if isinstance(view, numpy.ndarray) and len(view):
                with numpy.errstate(all="ignore"):
                    view[self.random.integers(0, len(view), 3)] = self.data.draw(st.sampled_from(HUGE))
        elif what == "change":
            effect = self.data.draw(st.sampled_from(sim.effects))
            name = self.data.draw(st.sampled_from([*effect.parameters, "other"]))
            self.call(sim.change, self.word(effect.name), **{name: self.number(0.5, 1.0)})
        elif what == "mesh":
            other = self.data.draw(st.sampled_from([mesh, mesh, None]))
            self.call(sim.set_mesh, self.word(other), bodies=often(self.data, st.none(), st.just([self.call(collide.Body, self.whole(0), self.whole(1)) or 1])))
        elif what == "copy":
            self.call(copy.deepcopy, sim)
        elif what in ("save", "load"):
            with tempfile.TemporaryDirectory() as folder:
                self.call(getattr(sim, what), self.word(os.path.join(folder, "state")))
        else:
            self.call({"energy": sim.energy, "sums": sim.sums, "text": sim.__repr__}[what], *((self.word("gravity"),) if what == "sums" else ()))


def describe(argument):
    if isinstance(argument, tuple) and len(argument) == 2:
        return f"{argument[0]}={describe(argument[1])}"
    if isinstance(argument, numpy.ndarray):
        return f"array({argument.dtype}, {argument.shape}, {argument.strides})"
    try:
        return repr(argument)[:80]
    except Exception:
        return type(argument).__name__


LISTS = [[collide.gravity()], [collide.gravity(), collide.bounce()], [collide.gravity(), collide.bounce(), collide.friction()],
         [collide.gravity(), collide.bounce(), collide.friction(), collide.spin()]]
HUNTS = bool(os.environ.get("COLLIDE_HUNT_SECONDS"))
if HUNTS:  # these are compiled, and the others of float64
    LISTS += [
        [collide.gravity(), collide.sphere_contact(), collide.bounce(), collide.friction()],
        [collide.emit(10, (0, 0, 1)), collide.gravity(), collide.sphere_contact(), collide.bounce(), collide.friction(), collide.spin()],
        [collide.polydisperse(), collide.gravity(), collide.sphere_contact(), collide.bounce(), collide.moving_bodies(), collide.sleep(), collide.reaction(1e-9)],
        [collide.gravity(), collide.granular_contact(collide.granular.hertz(), collide.granular.mindlin(), collide.granular.epsd()), collide.velocity_verlet()],
        [collide.gravity(), collide.sphere_contact(), collide.periodic_box((-2, -2, -2), (2, 2, 2)), collide.lost()],
    ]


class Meanwhile:
    """What another thread does during the calls: queries and updates of the same mesh, or new numbers in its arrays."""

    def __init__(self, data, mesh, vertices, centres):
        self.what = data.draw(st.sampled_from(["nothing", "nothing", "query", "update", "write"]))
        self.mesh, self.vertices, self.centres, self.ends = mesh, vertices, centres, threading.Event()
        self.thread = threading.Thread(target=self.work)

    def work(self):
        while not self.ends.is_set():
            if self.what == "query":
                self.mesh.query(self.centres, 0.3)
            elif self.what == "update":
                self.mesh.update(self.vertices.copy(), FACES)
            elif self.what == "write":
                self.centres[:] = self.centres[::-1].copy()
                self.vertices[:, 2] = 1 - self.vertices[:, 2]

    def __enter__(self):
        if self.what != "nothing":
            self.thread.start()

    def __exit__(self, *error):
        self.ends.set()
        if self.what != "nothing":
            self.thread.join()


def check_answers(mesh, dtype, random):
    """Spheres around points of a lattice touch the square or not: |z| and the distance beyond its sides, in rationals."""
    mesh.update(SQUARE.astype(dtype), FACES)
    x = (random.integers(-12, 13, (40, 3)) / 4).astype(dtype)
    for radius in (0.5, 1.25):
        beyond = [[max(abs(fractions.Fraction(float(p[k]))) - 1, 0) for k in (0, 1)] + [fractions.Fraction(float(p[2]))] for p in x]
        expected = [sum(d * d for d in row) <= fractions.Fraction(radius) ** 2 for row in beyond]
        assert mesh.any(x, radius).tolist() == expected


def in_a_child(work):
    """Whether a forked process comes to an end, and well."""
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        try:
            work()
            os._exit(0)
        except BaseException as error:
            os.write(2, f"in a child: {error!r}\n".encode())
            os._exit(1)
    assert os.waitpid(child, 0)[1] == 0


def example(data, log):
    calls = Calls(data, log)
    dtype, random = calls.dtype, calls.random
    vertices, centres = SQUARE.astype(dtype), random.normal(size=(200, 3)).astype(dtype)
    mesh = collide.Mesh(vertices, FACES)
    in_use[:] = [mesh]
    calls.mesh()
    meanwhile = Meanwhile(data, mesh, vertices, centres)
    with meanwhile:
        sim = calls.simulation(mesh) if dtype == "float32" or HUNTS else None
        for _ in range(data.draw(st.integers(1, 12))):
            what = data.draw(st.integers(0, 9))
            if what < 5:
                calls.query(mesh)
            elif what == 5:
                n = data.draw(st.sampled_from([0, 4, 4, 300]))
                calls.call(mesh.update, calls.points(n), calls.triangles(n), validate=calls.word(True, False))
            elif what == 6:
                calls.call(copy.deepcopy, mesh)
            elif sim is not None:
                calls.step(sim, mesh)
        if data.draw(st.integers(0, 9)) == 0:
            in_a_child(lambda: calls.call(mesh.count, centres, 0.3))
    check_answers(mesh, dtype, random)


def main(seconds, number, path):
    faulthandler.enable()
    end, tried = time.monotonic() + seconds, 0

    def handle(*_):  # a call from within others; but not from within itself, where it waits for another thread
        used, in_use[:] = in_use[:], []
        for mesh in used:
            with contextlib.suppress(*ALLOWED):
                mesh.count(SQUARE, 0)
        in_use[:] = used

    before = signal.signal(signal.SIGALRM, handle)
    signal.setitimer(signal.ITIMER_REAL, 0.05, 0.05)
    with open(path, "w") as log:
        while time.monotonic() < end:
            options = dict(max_examples=100, deadline=None, database=None, suppress_health_check=list(HealthCheck))

            @seed(number + tried)
            @settings(phases=[Phase.generate], **options)
            @given(st.data())
            def run(data):
                nonlocal tried
                tried += 1
                if time.monotonic() >= end:
                    return
                try:
                    example(data, log)
                except Exception:  # another time, with other threads, it may not happen
                    traceback.print_exc()
                    os._exit(1)

            with contextlib.suppress(Flaky):  # other threads have other results each time
                run()
    signal.setitimer(signal.ITIMER_REAL, 0)
    signal.signal(signal.SIGALRM, before)
    print(tried, "examples")


if __name__ == "__main__":
    main(float(sys.argv[1]), int(sys.argv[2]), sys.argv[3])
