"""Threads, forks, and the end of the interpreter."""

import os
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
