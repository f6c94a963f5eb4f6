"""Simulations: columns, parameters, lists that are compiled, errors."""

import copy
import os
import pickle
import subprocess
import sys

import numpy
import pytest

import collide
from collide import _build, _source

SQUARE = numpy.array([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], numpy.float32)
TRIANGLES = numpy.array([[0, 1, 2], [0, 2, 3]], numpy.int32)
ABOVE = numpy.array([[0, 0, 2], [1, 0, 3]], numpy.float32)
FALL = [collide.gravity(0, 0, -9.81), collide.bounce(0.5)]
HAS_COMPILER = any(os.access(os.path.join(p, "g++"), os.X_OK) for p in os.environ["PATH"].split(":"))
compiles = pytest.mark.skipif(not HAS_COMPILER, reason="there is no g++ here")


@pytest.fixture(autouse=True, scope="module")
def cache(tmp_path_factory):
    os.environ.setdefault("COLLIDE_CACHE", str(tmp_path_factory.mktemp("cache")))


def floor(dtype=numpy.float32):
    return collide.Mesh(SQUARE.astype(dtype), TRIANGLES)


def falling(dtype=numpy.float32, **options):
    sim = collide.Simulation(floor(dtype), FALL, **options)
    sim.set(ABOVE.astype(dtype), 0.25)
    return sim


def test_first_simulation():
    sim = falling()
    assert len(sim) == 2 and sim.columns == ["position", "velocity"] and sim.time == 0
    sim.steps(5000, 1e-3)
    assert numpy.allclose(sim["position"][:, 2], 0.25, atol=1e-3) and abs(sim.time - 5) < 1e-3
    assert sim.largest_time_step() == numpy.inf and sim.energy(1)["kinetic"] == 0


def test_columns_are_views():
    sim = falling()
    position = sim["position"]
    sim.step(1e-3)
    assert position[0, 2] < 2 and numpy.shares_memory(position, sim["position"])
    position[0] = (3, 3, 3)
    assert (sim["position"][0] == 3).all()
    sim["velocity"] = numpy.ones((2, 3), numpy.float32)
    assert (sim["velocity"] == 1).all()


def test_views_outlive_what_they_show():
    sim = falling()
    position, mesh = sim["position"], floor()
    sim.set(ABOVE[:1], 0.25)  # elsewhere, as the old columns are looked at
    assert position.shape == (2, 3) and (position == ABOVE).all() and len(sim) == 1
    sim.steps(5000, 1e-3)  # with effects and mesh as before
    assert abs(sim["position"][0, 2] - 0.25) < 1e-3
    del sim, mesh
    assert (position == ABOVE).all()


def test_velocities_strides_and_errors():
    sim = falling()
    wide = numpy.zeros((2, 5), numpy.float32)
    wide[:, 1:4] = ABOVE
    sim.set(wide[:, 1:4], 0.25, numpy.full((2, 3), 2, numpy.float32))
    assert (sim["velocity"] == 2).all() and (sim["position"] == ABOVE).all()
    bad = [
        (lambda: sim.set(ABOVE.astype(float), 0.25), TypeError, "centres: has dtype float64"),
        (lambda: sim.set(ABOVE, 0.25, wide[:, 1:4]), ValueError, "velocities: .* packed"),
        (lambda: sim.set(ABOVE, 0.25, ABOVE[:1]), ValueError, "velocities: has shape"),
        (lambda: sim.set(ABOVE, numpy.float32([1, 2])), collide.Error, "radii differ: name the effect polydisperse"),
        (lambda: sim.set(ABOVE, -1), ValueError, "radius: 2 sphere.* negative radius"),
        (lambda: sim.set(ABOVE, numpy.nan), ValueError, "radius: 2 sphere.* NaN radius"),
        (lambda: sim.set(ABOVE, numpy.float32([0.1, -1])), ValueError, "radius: 1 sphere.* negative radius, .* number 1"),
        (lambda: sim.set(ABOVE, 0.25, capacity=-1), ValueError, "capacity: is -1"),
        (lambda: sim.steps(10.0, 1e-3), TypeError, "n: expected a whole number, got 10.0"),
        (lambda: sim.step("1"), TypeError, "dt: expected a number, got '1'"),
        (lambda: sim.energy("1"), TypeError, "density: expected a number"),
        (lambda: sim.save("a\0b"), ValueError, "path: has a null character"),
        (lambda: sim.load(5), TypeError, "path: expected one, got 5"),
        (lambda: sim.set_mesh("floor"), TypeError, "mesh: expected a collide.Mesh, got 'floor'"),
        (lambda: sim.set_mesh(bodies=[1]), TypeError, "bodies: expected bodies such as"),
        (lambda: sim.sums(numpy.zeros(2)), ValueError, "effect: there is no array"),
        (lambda: collide.Body(10**300, 1), ValueError, "first: is "),
        (lambda: collide.Body(0, 0.5), TypeError, "size: expected a whole number, got 0.5"),
        (lambda: collide.Body(0, 1, pivot=(1, 2)), ValueError, "pivot: expected 3 numbers"),
        (lambda: collide.Simulation("floor", FALL), TypeError, "mesh: expected a collide.Mesh"),
        (lambda: collide.Simulation(floor(), None), TypeError, "effects: expected effects such as .* got None"),
        (lambda: collide.Simulation(floor(), FALL[:1] * 2), ValueError, "effects: gravity is in the list more than once"),
        (lambda: collide.Effect("a b"), ValueError, "name: expected that of a struct, got 'a b'"),
        (lambda: sim.step(0), collide.Error, "dt of a step"),
        (lambda: sim.steps(-1, 0.1), ValueError, "n: is -1, expected 0 to"),
        (lambda: sim["spin"], KeyError, "there is no column 'spin' in this simulation; there are position, velocity"),
        (lambda: sim.__setitem__("velocity", ABOVE[:1]), ValueError, "velocity: has shape"),
        (lambda: sim.__setitem__("velocity", ABOVE.astype(float)), TypeError, "velocity: has dtype float64"),
        (lambda: sim.change("spin", x=1), ValueError, "effect: there is no 'spin'"),
        (lambda: sim.change("gravity", w=1), ValueError, "w: gravity has no such parameter; it has x, y, z"),
        (lambda: sim.change("gravity", z=(1, 2, 3)), ValueError, "z: expected a number, got .1, 2, 3."),
        (lambda: collide.gravity(z="down"), TypeError, "z: expected numbers"),
        (lambda: collide.box_walls((0, 0), (1, 1, 1)), ValueError, "lower: expected 3 numbers, got .0, 0."),
        (lambda: collide.gravity(w=1), TypeError, "unexpected keyword argument 'w'"),
        (lambda: collide.Simulation(floor(), ["gravity"]), TypeError, "effects: expected effects"),
        (lambda: collide.Simulation(floor(), FALL, precision="good"), ValueError, "precision: is 'good'"),
    ]
    for call, error, text in bad:
        with pytest.raises(error, match=text):
            call()
    fresh = collide.Simulation(floor(), FALL)
    with pytest.raises(collide.Error, match="call set before it"):
        fresh.step(1e-3)


def test_parameters_change():
    sim = falling()
    sim.change("gravity", z=0)
    sim.steps(100, 1e-3)
    assert (sim["position"] == ABOVE).all() and "z=0" in repr(sim.effects[0])
    with pytest.raises(collide.Error, match="restitution"):
        sim.change(1, restitution=3)
        sim.step(1e-3)


def test_mesh_moves():
    vertices = SQUARE.copy()
    mesh = collide.Mesh(vertices, TRIANGLES)
    sim = collide.Simulation(mesh, FALL)
    sim.set(ABOVE, 0.25)
    sim.steps(5000, 1e-3)
    vertices[:, 2] = -2
    mesh.update(vertices)
    sim.set_mesh()
    sim.steps(5000, 1e-3)
    assert numpy.allclose(sim["position"][:, 2], -1.75, atol=1e-3)


def test_mesh_moves_to_other_arrays():
    """Without set_mesh: the next step sees it, and nothing reads memory that is gone. So with half a million vertices."""
    fine = numpy.repeat(SQUARE[TRIANGLES].reshape(-1, 3), 100_000, axis=0).reshape(2, 3, -1, 3).swapaxes(1, 2).reshape(-1, 3)
    for vertices in (SQUARE[TRIANGLES].reshape(-1, 3), numpy.ascontiguousarray(fine)):
        mesh = collide.Mesh(vertices.copy())
        sim = collide.Simulation(mesh, FALL)
        sim.set(ABOVE, 0.25)
        sim.steps(10, 1e-3)
        mesh.update(vertices + numpy.float32([0, 0, -2]))
        sim.steps(5000 if len(vertices) < 10 else 10, 1e-3)
        assert sim["position"].shape == (2, 3) and (len(vertices) > 10 or numpy.allclose(sim["position"][:, 2], -1.75, atol=1e-3))
        del mesh
        sim.steps(1, 1e-3)


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_copies(copied):
    sim = falling()
    sim.change("gravity", z=-5)
    sim.steps(100, 1e-3)
    other = copied(sim)
    assert other.time == sim.time and other["position"].tobytes() == sim["position"].tobytes()
    sim.steps(900, 1e-3)
    before = other["position"].copy()
    assert (before == other["position"]).all()
    other.steps(900, 1e-3)
    assert other["position"].tobytes() == sim["position"].tobytes() and other.effects[0].parameters["z"] == [-5]
    assert len(copied(collide.Simulation(floor(), FALL))) == 0


def test_effects_of_a_generator():
    sim = collide.Simulation(floor(), (effect for effect in FALL))
    sim.set(ABOVE, 0.25)
    sim.steps(10, 1e-3)
    assert len(sim.effects) == 2 and sim["velocity"][0, 2] < 0 and "velocity" in sim and "spin" not in sim


def test_save_and_load(tmp_path):
    whole, first, second = falling(), falling(), falling()
    whole.steps(400, 1e-3)
    first.steps(150, 1e-3)
    first.save(tmp_path / "state")
    second.load(tmp_path / "state")
    second.steps(250, 1e-3)
    assert (whole["position"] == second["position"]).all() and whole.time == second.time
    with pytest.raises(collide.Error):
        second.load(tmp_path / "nothing")


def test_all_lists_of_the_package_work():
    there = os.listdir(os.path.join(os.path.dirname(collide.__file__), "lists"))
    tried = 0
    for effects in _source.BUILT_IN:
        names = [effect.name for effect in effects]
        scalar = "double" if "granular_contact" in names else "float"
        if _source.name_of(_source.source(effects, scalar=scalar)) + ".so" not in there:
            continue
        dtype = numpy.float64 if scalar == "double" else numpy.float32
        sim = collide.Simulation(floor(dtype), effects)
        radius = numpy.array([0.25, 0.2], dtype) if "polydisperse" in names else 0.25
        sim.set(ABOVE.astype(dtype), radius, capacity=5 if "emit" in names else 0)
        sim.steps(100, 1e-3)
        assert numpy.isfinite(sim["position"]).all()
        tried += 1
    assert tried == len(there) > 0


@compiles
def test_a_list_is_compiled_once(tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("COLLIDE_CACHE", str(tmp_path / "cache"))
    results = []
    for _ in range(2):
        sim = collide.Simulation(floor(), [collide.wind(1, 0, 0, linear=2)])
        sim.set(ABOVE, 0.25)
        sim.steps(2000, 1e-3)
        results.append(sim["velocity"].copy())
    progress = capfd.readouterr().err
    assert progress.count("compiles a simulation of wind") == 1 and "kept in" in progress
    assert numpy.allclose(results[0], [1, 0, 0], atol=0.1) and (results[0] == results[1]).all()
    assert len(list((tmp_path / "cache").iterdir())) == 1


@compiles
def test_energy_and_files_are_compiled_when_they_are_asked_for(tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("COLLIDE_CACHE", str(tmp_path / "cache"))

    def made():
        sim = collide.Simulation(floor(), [collide.wind(1, 0, 0, linear=2)])
        sim.set(ABOVE, 0.25)
        sim.steps(10, 1e-3)
        return sim

    sim = made()
    monkeypatch.setenv("CXX", "no-such-compiler")
    with pytest.raises(collide.Error, match="there is no compiler"):
        sim.energy(1000)
    sim.steps(10, 1e-3)  # goes on
    monkeypatch.delenv("CXX")
    mass = 1000 * 4 / 3 * numpy.pi * 0.25**3
    expected = 0.5 * mass * (sim["velocity"].astype(float) ** 2).sum()
    assert expected > 0 and abs(sim.energy(1000)["kinetic"] / expected - 1) < 1e-6
    assert sim.contact_report().contacts == 0
    sim.save(tmp_path / "saved")
    other = made()
    shown = other["velocity"]  # so that the particles are those of another compiled simulation
    before = shown.copy()
    other.load(tmp_path / "saved")
    assert (other["velocity"] == sim["velocity"]).all() and (shown == before).all() and other.time == sim.time
    assert other.energy(1000) == sim.energy(1000)
    assert (pickle.loads(pickle.dumps(sim))["velocity"] == sim["velocity"]).all()
    progress = capfd.readouterr().err
    assert progress.count("compiles a simulation of wind") == 1
    assert progress.count("compiles energy, contact_report, save and load of wind") == 1
    assert len(list((tmp_path / "cache").iterdir())) == 2


SPRING = """struct spring {
  using reads = collide::columns<collide::position>;
  using writes = collide::columns<collide::velocity>;
  double stiffness = 1;
  double centre[3] = {0, 0, 0};
  template <class Particle, class S>
  COLLIDE_HD_INLINE void accelerate(Particle& p, S dt) const {
    collide::vec3<S> const x = p[collide::position{}];
    collide::vec3<S>& v = p[collide::velocity{}];
    for (int k = 0; k < 3; ++k) v[k] += (S(centre[k]) - x[k]) * (S(stiffness) * dt);
  }
};"""


@compiles
def test_own_effect_in_doubles_and_swept():
    spring = collide.Effect("spring", {"stiffness": 4.0, "centre": (0, 0, 1)}, code=SPRING)
    sim = collide.Simulation(floor(numpy.float64), [spring, collide.bounce()], swept=True)
    sim.set(ABOVE.astype(float), 0.25)
    sim.steps(1, 1e-3)
    assert numpy.allclose(sim["velocity"], (numpy.array([0, 0, 1]) - ABOVE) * 4e-3)
    assert sim["velocity"].dtype == float
    sim.change("spring", stiffness=0)
    before = sim["velocity"].copy()
    sim.steps(1, 1e-3)
    assert (before == sim["velocity"]).all()


@compiles
def test_bodies():
    effects = [collide.gravity(), collide.bounce(0), collide.friction(0.9), collide.moving_bodies()]
    belt = collide.Body(0, 2, belt=(1, 0, 0))
    sim = collide.Simulation(floor(), effects, bodies=[belt])
    sim.set(numpy.float32([[0, 0, 0.25]]), 0.25)
    sim.steps(1000, 1e-3)
    assert abs(sim["velocity"][0, 0] - 1) < 1e-3
    with pytest.raises(collide.Error, match="triangles"):
        sim.set_mesh(bodies=[collide.Body(1, 2)])


@compiles
def test_what_does_not_fit_together_says_so():
    with pytest.raises(collide.Error, match="friction and adhesion act where the mesh is solid, and wear where granular_contact presses: name bounce, "):
        collide.Simulation(floor(), [collide.friction()])


@compiles
def test_a_mistake_in_an_effect_is_shown():
    wrong = SPRING.replace("v[k] +=", "velocity[k] +=")
    with pytest.raises(collide.Error) as error:
        collide.Simulation(floor(), [collide.gravity(), collide.Effect("spring", {"stiffness": 4.0}, code=wrong)])
    lines = str(error.value).splitlines()
    assert any(line.startswith("effect spring:10:") and "error: " in line for line in lines) and len(lines) < 20
    assert any("velocity[k] +=" in line for line in lines)


def test_without_a_compiler(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    falling()  # in the package
    with pytest.raises(collide.Error, match="(?s)no compiler for it.*gravity, bounce"):
        collide.Simulation(floor(), [collide.lost()])


def test_the_cache_knows_what_a_library_is_made_of(monkeypatch, tmp_path):
    monkeypatch.setenv("COLLIDE_CACHE", str(tmp_path))
    assert _build.cache() == tmp_path
    monkeypatch.delenv("COLLIDE_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert _build.cache() == tmp_path / "collide"


def test_two_processes_compile_at_once(tmp_path):
    if not HAS_COMPILER:
        pytest.skip("there is no g++ here")
    code = "import collide, numpy; m = collide.Mesh(numpy.zeros((3, 3), 'float32')); collide.Simulation(m, [collide.drag(1)])"
    env = {**os.environ, "COLLIDE_CACHE": str(tmp_path)}
    running = [subprocess.Popen([sys.executable, "-c", code], env=env) for _ in range(2)]
    assert [p.wait() for p in running] == [0, 0] and len(list(tmp_path.iterdir())) == 1
