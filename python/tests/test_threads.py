"""Threads, forks, and the end of the interpreter."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy
import pytest

import collide


def big(seed, n=200_000, m=2000):
    random = numpy.random.default_rng(seed)
    vertices = random.uniform(0, 1, (m, 1, 3)) + random.normal(0, 0.02, (m, 3, 3))
    return vertices.reshape(-1, 3).astype(numpy.float32), random.uniform(0, 1, (n, 3)).astype(numpy.float32)


def test_other_threads_run():
    vertices, centres = big(0)
    mesh, ticks, done = collide.Mesh(vertices), [0], threading.Event()

    def tick():
        while not done.is_set():
            ticks[0] += 1
            time.sleep(0.0005)

    thread = threading.Thread(target=tick)
    thread.start()
    mesh.query(centres, 0.05)
    begin, before = time.perf_counter(), ticks[0]
    while time.perf_counter() - begin < 0.3:
        mesh.query(centres, 0.05)
    after = ticks[0]
    done.set()
    thread.join()
    assert after - before > 10


@pytest.mark.parametrize("shared", [False, True])
def test_threads_get_what_one_gets(shared):
    scenes = [big(seed, 20_000, 500) for seed in range(4)]
    meshes = [collide.Mesh(scenes[0][0])] * 4 if shared else [collide.Mesh(v, threads=1) for v, _ in scenes]
    expected = [m.query(c, 0.05, order="canonical").records for m, (_, c) in zip(meshes, scenes)]
    wrong = []

    def work(i):
        for _ in range(20):
            found = meshes[i].query(scenes[i][1], 0.05, order="canonical").records
            if not numpy.array_equal(found, expected[i]):
                wrong.append(i)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_forked_processes_run_on_the_host():
    vertices, centres = big(0)
    mesh = collide.Mesh(vertices)
    expected = mesh.count(centres, 0.05)  # OpenMP has its threads by now
    child = os.fork()
    if child == 0:
        same = mesh.count(centres, 0.05) == expected and collide.Mesh(vertices).count(centres, 0.05) == expected
        os._exit(0 if same else 1)
    deadline = time.monotonic() + 60
    while (status := os.waitpid(child, os.WNOHANG))[0] == 0 and time.monotonic() < deadline:
        time.sleep(0.01)
    if status[0] == 0:
        os.kill(child, 9)
    assert status == (child, 0)


def child_of(work):
    """What a child of this process says; None if it hangs."""
    child = os.fork()
    if child == 0:
        try:
            os._exit(work())
        finally:
            os._exit(99)
    deadline = time.monotonic() + 60
    while (status := os.waitpid(child, os.WNOHANG))[0] == 0 and time.monotonic() < deadline:
        time.sleep(0.01)
    if status[0] == 0:
        os.kill(child, 9)
        os.waitpid(child, 0)
        return None
    return os.waitstatus_to_exitcode(status[1])


def test_a_fork_while_another_thread_works():
    """The child may not use what the other thread uses, and says so; but all else."""
    vertices, centres = big(0, 3_000_000)
    mesh, other, done = collide.Mesh(vertices), collide.Mesh(vertices), threading.Event()

    def work():
        while not done.is_set():
            mesh.count(centres, 0.05)

    def use():
        try:
            mesh.count(centres[:10], 0.05)
            return 1
        except collide.Error as error:
            text = str(error)
        globals().pop("mesh", None)
        return 0 if "forked while another thread used" in text and other.count(centres[:10], 0.05) >= 0 else 2

    thread = threading.Thread(target=work)
    thread.start()
    time.sleep(0.3)
    said = child_of(use)
    done.set()
    thread.join()
    assert said == 0 and child_of(lambda: int(mesh.count(centres[:10], 0.05) < 0)) == 0


class Interrupt:
    """Sends SIGINT to this process in a while."""

    def __init__(self, seconds):
        self.timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))

    def __enter__(self):
        self.timer.start()

    def __exit__(self, *error):
        self.timer.join()


def test_ctrl_c_ends_queries_and_steps():
    """Within a second, and all is as it was."""
    vertices, centres = big(0, 10_000)
    many = numpy.broadcast_to(numpy.float32([0.5, 0.5, 0.5]), (2**31 - 1, 3))  # for hours
    mesh = collide.Mesh(vertices)
    expected = mesh.query(centres, 0.05, order="canonical").records
    calls = [lambda: mesh.count(many, 0.4), lambda: mesh.query(many, 0.4, output="csr"), lambda: mesh.impacts(many, many, 0.4),
             lambda: mesh.query(many, 0.4, out=numpy.zeros((5, 2), numpy.int32))]
    for call in calls:
        with Interrupt(0.2), pytest.raises(KeyboardInterrupt):
            begin = time.monotonic()
            call()
        assert time.monotonic() - begin < 5  # 0.4 where nothing else runs
        assert (mesh.query(centres, 0.05, order="canonical").records == expected).all()
    sim = collide.Simulation(mesh, [collide.gravity()])
    sim.set(centres, 0.01)
    with Interrupt(0.2), pytest.raises(KeyboardInterrupt):
        sim.steps(10**12, 2.0**-30)
    n = round(sim.time * 2**30)
    same = collide.Simulation(mesh, [collide.gravity()])
    same.set(centres, 0.01)
    same.steps(n, 2.0**-30)
    assert 0 < n < 10**12 and sim["position"].tobytes() == same["position"].tobytes()


def test_ctrl_c_ends_waiting_for_another_thread():
    vertices, centres = big(0, 3_000_000)
    mesh, done = collide.Mesh(vertices), threading.Event()

    def work():
        while not done.is_set():
            mesh.count(centres, 0.2)

    thread = threading.Thread(target=work)
    thread.start()
    time.sleep(0.1)
    with pytest.raises(KeyboardInterrupt), Interrupt(0.3):
        while True:
            mesh.count(centres, 0.2)
    done.set()
    thread.join()


def test_a_call_from_within_a_call():
    """From a signal's handler, and from an argument's __dlpack__: an error, where it would wait for itself."""
    vertices, centres = big(0, 3_000_000)
    mesh, found = collide.Mesh(vertices), []

    class Curious:
        def __dlpack_device__(self):
            return 1, 0

        def __dlpack__(self, **options):
            return mesh.count(centres, 0.05)

    with pytest.raises(TypeError, match="a call from within another one"):
        mesh.count(Curious(), 0.05)

    def handle(number, frame):
        try:
            found.append(mesh.count(centres[:5], 0.05))
        except collide.Error as error:
            found.append(str(error))

    before = signal.signal(signal.SIGUSR1, handle)
    try:
        thread = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGUSR1))
        thread.start()
        while not found:
            mesh.count(centres, 0.2)
        thread.join()
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert isinstance(found[0], int) or "a call from within another one" in found[0]


def test_views_are_good_while_another_thread_sets():
    """Whatever is set, what was looked at stays: each view has the numbers of one set."""
    mesh = collide.Mesh(big(0, 1, 1)[0])
    sim = collide.Simulation(mesh, [collide.gravity()])
    sim.set(numpy.zeros((2000, 3), numpy.float32), 1)
    done, wrong = threading.Event(), []

    def look():
        while not done.is_set():
            view = sim["position"]
            if not (view == view.flat[0]).all() or len(view) != 2000 + view.flat[0]:
                wrong.append(view)

    threads = [threading.Thread(target=look) for _ in range(2)]
    for thread in threads:
        thread.start()
    for number in range(300):
        sim.set(numpy.full((2000 + number, 3), number, numpy.float32), 1)
    done.set()
    for thread in threads:
        thread.join()
    assert wrong == []


END = """
import threading, time, numpy, collide
random = numpy.random.default_rng(0)
corners = random.uniform(0, 1, (10000, 1, 3)) + random.normal(0, 0.01, (10000, 3, 3))
mesh = collide.Mesh(corners.reshape(-1, 3).astype('float32'))
centres = random.uniform(0, 1, (100000, 3)).astype('float32')
mesh.count(centres[:10], 0.02)
def work():
    while True:
        mesh.any(centres, 0.02)
for _ in range(2):
    threading.Thread(target=work, daemon=True).start()
time.sleep(0.2)
kept = mesh.query(centres[:1000], 0.02)
print('ends')
"""


def test_the_interpreter_ends_with_work_under_way():
    for _ in range(3):
        done = subprocess.run([sys.executable, "-c", END], capture_output=True, text=True, timeout=120)
        assert (done.returncode, done.stdout.strip()) == (0, "ends"), done.stderr
        assert done.stderr == ""


def test_no_memory_is_lost():
    """A thousand queries and simulations take no more memory than ten."""
    import resource

    vertices, centres = big(0, 5000, 500)
    mesh = collide.Mesh(vertices)
    sim = collide.Simulation(mesh, [collide.gravity()])
    sizes = []
    for round_ in (20, 400):
        for _ in range(round_):
            mesh.contacts(centres, 0.05)
            mesh.query(centres, 0.05, capacity=1000)
            mesh.update(vertices)
            sim.set(centres, 0.05)
            sim["position"]
        sizes.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    assert sizes[1] - sizes[0] < 30_000  # KB; what 400 rounds make is some 300,000
