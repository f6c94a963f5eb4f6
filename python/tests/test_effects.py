"""The table of effects is that of C++; granular contact."""

import os
import pathlib
import subprocess

import numpy
import pytest

import collide
from collide import _source, effects, granular
from test_simulation import SQUARE, TRIANGLES, cache, compiles  # noqa: F401: a fixture

HERE = pathlib.Path(collide.__file__).parent
INF = float("inf")
REQUIRED = {  # arguments that have no defaults in Python, as C++ has them
    "emit": (0, (0, 0, 0)), "absorbing_box": ((0,) * 3, (0,) * 3), "box_walls": ((-INF,) * 3, (INF,) * 3),
    "periodic_box": ((0,) * 3, (1,) * 3), "reaction": (0,), "mass_flow": ((0, 0, 0), (0, 0, 1), 0), "wear": (0, 0),
}
THREE = granular.materials([granular.Solid()] * 3, granular.SurfacePair())
GRANULAR = [
    collide.granular_contact(granular.linear(), granular.dashpot(), granular.constant_torque(), granular.sjkr()),
    collide.granular_contact(granular.hertz(), granular.mindlin(), granular.epsd(), granular.jkr(), materials=THREE),
    collide.granular_contact(granular.hertz(), granular.mindlin_rescale(), granular.epsd2(), granular.dmt()),
    collide.granular_contact(granular.hertz(), granular.mindlin_force(), cohesion=granular.sjkr()),
    collide.granular_contact(granular.linear(), granular.cundall_strack(), granular.marshall(granular.epsd())),
    collide.granular_contact(granular.linear(), granular.cundall_strack(), granular.torsion()),
]
PROGRAM = """
#include <cstdio>
struct printer {
  template <class Number> void operator()(char const* name, Number const& x) const { std::printf("%s %.17g\\n", name, double(x)); }
  void operator()(char const* name, double const (&x)[3]) const { std::printf("%s %.17g %.17g %.17g\\n", name, x[0], x[1], x[2]); }
  template <class Set> void operator()(char const*, std::size_t, Set const&) const {}
};
"""


@compiles
def test_parameters_and_defaults_are_those_of_cpp(tmp_path):
    every = [getattr(effects, name)(*REQUIRED.get(name, ())) for name in effects.__all__] + GRANULAR
    calls = "".join(f'  {{ {e._type} e; std::puts("="); collide_python::parameters(e, printer()); }}\n' for e in every)
    (tmp_path / "table.cpp").write_text(_source.parameters_of(every) + PROGRAM + f"int main() {{\n{calls}}}\n")
    command = ["g++", "-std=c++17", f"-I{HERE / 'include'}", f"-I{HERE / 'src'}", "table.cpp", "-o", "table"]
    subprocess.run(command, cwd=tmp_path, check=True)
    printed = subprocess.run([tmp_path / "table"], capture_output=True, text=True, check=True).stdout
    of_cpp = [dict(line.split(" ", 1) for line in part.splitlines() if line) for part in printed.split("=\n")[1:]]
    assert len(of_cpp) == len(every)
    for effect, members in zip(every, of_cpp):
        mine = {key: values for key, values in effect.parameters.items() if key != "materials"}
        assert {key: [float(x) for x in numbers.split()] for key, numbers in members.items()} == mine, effect


def test_every_effect_of_the_library_is_there():
    every = [getattr(effects, name)(*REQUIRED.get(name, ())) for name in effects.__all__] + GRANULAR
    headers = {path.relative_to(HERE / "include").as_posix() for path in (HERE / "include/collide/effects").rglob("*.hpp")
               if "detail" not in path.parts}
    named = {word for effect in every for word in effect.code.replace("<", " ").replace(">", " ").split() if "/" in word}
    of_no_effect = ["columns", "effect", "granular/materials"]
    assert headers - named == {f"collide/effects/{name}.hpp" for name in of_no_effect}


def sphere_mass(radius, density):
    return density * 4 / 3 * numpy.pi * radius**3


@compiles
def test_reaction_is_what_particles_lose():
    """Impulse and moment of the mesh are those that particles lose beside their weight; bodies and triangles share them."""
    square = numpy.vstack([SQUARE, SQUARE + [20, 0, 0]]).astype(float)
    mesh = collide.Mesh(square, numpy.vstack([TRIANGLES, TRIANGLES + 4]))
    listed = [collide.gravity(), collide.bounce(0.5), collide.friction(0.3), collide.moving_bodies()]
    unit, density, radius = 1e-12, 2500, 0.05
    listed.append(collide.reaction(unit, density, triangles=True))
    sim = collide.Simulation(mesh, listed, bodies=[collide.Body(2, 2)])  # the second square; the first one is at rest
    x = numpy.random.default_rng(3).uniform(-4, 4, (400, 3)) + [0, 0, 5]
    x[::4, 0] += 20
    v = numpy.random.default_rng(4).normal(size=(400, 3))
    sim.set(x, radius, v)
    mass, weight, steps, dt = sphere_mass(radius, density), numpy.array([0, 0, -9.81]), 1500, 1e-3
    on_body = slice(0, None, 4), [i for i in range(400) if i % 4]
    position, moment_of_weight = sim["position"], numpy.zeros((400, 3))
    for _ in range(steps):
        moment_of_weight += numpy.cross(position, weight) * dt  # half a step early, as velocity changes first
        sim.step(dt)
    found = sim.sums("reaction")
    assert found.bodies == 1 and found.refused == 0 and found.linear.shape == found.angular.shape == (2 + 4, 3)
    lost = mass * (v + weight * steps * dt - sim["velocity"])
    turned = mass * (numpy.cross(x, v) + moment_of_weight - numpy.cross(position, sim["velocity"]))
    for row, who in enumerate(on_body):
        assert numpy.abs(lost[who].sum(0)).max() > 1
        assert numpy.allclose(found.linear[row], lost[who].sum(0), rtol=1e-9, atol=1e-7)
        assert numpy.allclose(found.angular[row], turned[who].sum(0), rtol=1e-6, atol=1e-6)
    of_triangles = found.linear[2:]
    assert numpy.allclose(of_triangles[:2].sum(0), found.linear[1], atol=1e-7)
    assert numpy.allclose(of_triangles[2:].sum(0), found.linear[0], atol=1e-7)


@compiles
def test_reaction_is_the_weight_of_what_rests():
    """Also where arrays of Python look at columns when others are set."""
    mesh = collide.Mesh(SQUARE.astype(float), TRIANGLES)
    listed = [collide.gravity(), collide.bounce(0), collide.friction(0), collide.moving_bodies(), collide.reaction(1e-9, 1000)]
    sim = collide.Simulation(mesh, listed)
    radius, n, weight = 0.25, 3, sphere_mass(0.25, 1000) * 9.81
    for density in (1000, 3000):
        sim.change("reaction", density=density)
        kept = None
        for _ in range(2):
            sim.set(numpy.array([[0, 0, 0.25], [1, 0, 0.25], [2, 0, 0.25]]), radius)
            sim.steps(100, 1e-3)
            assert numpy.allclose(sim.sums(4).linear, [[0, 0, -n * weight * density / 1000 * 0.1]], rtol=1e-9)
            kept = sim["position"]  # and the next set makes other columns
        sim.clear(4)
        assert (sim.sums("reaction").linear == 0).all()
        sim.steps(50, 1e-3)
        assert numpy.allclose(sim.sums(4).linear[0, 2], -n * weight * density / 1000 * 0.05, rtol=1e-9)
    assert kept is not None
    with pytest.raises(collide.Error, match="reaction: density and unit are above 0"):
        sim.change("reaction", unit=0)
        sim.step(1e-3)


@compiles
def test_reaction_of_other_bodies():
    """Other bodies: sums begin anew, for as many."""
    mesh = collide.Mesh(SQUARE.astype(float), TRIANGLES)
    listed = [collide.gravity(), collide.bounce(0), collide.friction(0), collide.moving_bodies(), collide.reaction(1e-12, 1000)]
    sim = collide.Simulation(mesh, listed)
    sim.set(numpy.array([[0, 0, 0.25]]), 0.25)
    sim.steps(10, 1e-3)
    assert sim.sums("reaction").linear.shape == (1, 3) and sim.sums("reaction").linear[0, 2] < 0
    sim.set_mesh(bodies=[collide.Body(0, 1), collide.Body(1, 1)])
    assert (sim.sums("reaction").linear == numpy.zeros((3, 3))).all()
    sim.steps(10, 1e-3)
    found = sim.sums("reaction").linear
    assert found[2].tolist() == [0, 0, 0] and numpy.isclose(found[:, 2].sum(), -0.01 * 9.81 * sphere_mass(0.25, 1000), rtol=1e-9)


@compiles
def test_wear_is_the_weight_of_what_lies_on_a_floor():
    mesh = collide.Mesh(SQUARE.astype(float), TRIANGLES)
    density, radius = 1000, 0.05
    contact = collide.granular_contact(granular.hertz(), granular.mindlin(), materials=granular.materials(
        granular.Solid(1e6, 0.3, density), granular.SurfacePair(0.2, 0.5)))
    effects = [collide.gravity(), contact, collide.wear(1e-12, 1e-12, density), collide.velocity_verlet()]
    sim = collide.Simulation(mesh, effects)
    sim.set(numpy.array([[0.3, 0.2, radius]]), radius)
    sim.steps(4000, 5e-5)
    sim.clear("wear")
    sim.steps(2000, 5e-5)
    loads = sim.sums("wear")
    assert loads.normal_impulse.shape == (len(TRIANGLES),)
    assert abs(loads.normal_impulse.sum() / (sphere_mass(radius, density) * 9.81 * 0.1) - 1) < 0.01
    assert abs(loads.sliding_work).max() < 1e-6


@compiles
def test_contact_work_is_what_a_rebound_loses():
    mesh = collide.Mesh(SQUARE.astype(float), TRIANGLES)
    contact = collide.granular_contact(granular.hertz(), materials=granular.materials(
        granular.Solid(1e7, 0.2, 2500), granular.SurfacePair(0.6)))
    sim = collide.Simulation(mesh, [collide.gravity(), contact, collide.contact_work(2500), collide.velocity_verlet()])
    sim.set(numpy.array([[0.3, 0.2, 0.0101]]), 0.01, numpy.array([[0.0, 0, -1]]))
    before = sim.energy()
    sim.steps(4000, 1e-6)
    after = sim.energy()
    assert abs(after["damping"] / (sphere_mass(0.01, 2500) / 2) - 0.64) < 0.01
    kept = [sum(e.values()) - 2 * e["given"] for e in (before, after)]
    assert after["given"] == 0 and abs(kept[1] / kept[0] - 1) < 1e-12


@compiles
def test_mass_flow_counts_what_passes():
    """Particles that fall through a plane, and those that pass its disc; back again they count backwards. In float32."""
    mesh = collide.Mesh(SQUARE, TRIANGLES)
    x = numpy.random.default_rng(1).uniform(-3, 3, (500, 3)).astype(numpy.float32)
    radius, density = 0.125, 700
    for disc in (INF, 2.0):
        through = collide.mass_flow((0, 0, 0.5), (0, 0, -2), 1e-9, density=density, disc=disc)
        sim = collide.Simulation(mesh, [collide.gravity(0, 0, -1), through])
        sim.set(x, radius)
        sim.steps(2000, 1e-3)  # each falls by 2
        fell = (x[:, 2] > 0.5) & (x[:, 2] < 2.5) & (numpy.hypot(x[:, 0], x[:, 1]) <= disc)
        found = sim.sums("mass_flow")
        assert found.particles == fell.sum() > 10
        assert numpy.isclose(found.mass, fell.sum() * sphere_mass(radius, density), rtol=1e-9)
    sim.clear("mass_flow")
    assert sim.sums(1) == (0, 0)
    velocity = sim["velocity"]
    velocity[:, 2] *= -1
    sim.steps(2000, 1e-3)  # and back, and a little more or less
    assert abs(sim.sums("mass_flow").particles + fell.sum()) <= 1


def test_only_sums_are_read():
    sim = collide.Simulation(collide.Mesh(SQUARE, TRIANGLES), [collide.gravity(), collide.bounce()])
    with pytest.raises(ValueError, match="effect: gravity has no sums; reaction, mass_flow and wear have"):
        sim.sums("gravity")
    with pytest.raises(ValueError, match="effect: there is no 'reaction' in the list gravity, bounce"):
        sim.sums("reaction")


@compiles
def test_granular_contact_of_two_materials():
    """Grains that fall on a floor rebound as their pair with it says, and one that is pushed rolls."""
    solids = [granular.Solid(1e7, 0.2, 2500), granular.Solid(1e7, 0.3, 1000)]
    pairs = {(0, 0): granular.SurfacePair(0.9), (1, 0): granular.SurfacePair(0.5), (1, 1): granular.SurfacePair(0.7, 0.5)}
    materials = granular.materials(solids, pairs)
    law = collide.granular_contact(
        granular.hertz(), granular.mindlin(), granular.epsd(), materials=materials, wall_material=1
    )
    mesh = collide.Mesh(SQUARE.astype(float), TRIANGLES)
    sim = collide.Simulation(mesh, [law, collide.velocity_verlet()])
    radius, speed = 0.01, 0.2
    start = numpy.array([[0, 0, 0.0101], [1, 0, 0.0101]])
    dt = None
    for change, expected in (({}, [0.5, 0.7]), ({"materials": granular.materials(solids, granular.SurfacePair(0.3))}, [0.3, 0.3])):
        if change:
            sim.change("granular_contact", **change)
        sim.set(start, radius, numpy.array([[0, 0, -speed]] * 2))
        sim["material"] = numpy.array([0, 1], numpy.uint8)
        dt = sim.largest_time_step() / 5
        sim.steps(int(5e-3 / dt), dt)
        assert numpy.allclose(sim["velocity"][:, 2] / speed, expected, atol=0.01) and (sim["position"][:, 2] > radius).all()
    with pytest.raises(ValueError, match="material: is 200, and there are 2, from 0"):
        sim["material"] = numpy.array([0, 200], numpy.uint8)
    assert "angular_velocity" in sim.columns and 0 < dt < 1e-3
    sim.change("granular_contact", materials=granular.materials(solids, granular.SurfacePair(0.3, 0.5)))
    sim.set(numpy.array([[0, 0, radius - 1e-6], [1, 0, radius - 1e-6]]), radius, numpy.array([[0.01, 0, 0]] * 2))
    sim.steps(2, dt)
    assert sim.energy()["tangential"] > 0 and sim.energy()["sliding"] == 0
    assert sim.effects[0].parameters["tangential_stiffness_factor"] == [1]
    with pytest.raises(collide.Error, match="Young's modulus"):
        sim.change("granular_contact", materials=granular.materials([granular.Solid(-1)] * 2, granular.SurfacePair()))


@compiles
def test_own_law_among_those_of_the_library():
    code = """struct stiff {
  static constexpr bool is_hertzian = false;
  static constexpr double damping_factor = 2;
  double stiffness = 1;
  template <class S>
  COLLIDE_HD_INLINE collide::normal_force<S> force(collide::granular_pair<S> const& p, collide::detail::contact_material const&) const {
    return {S(stiffness) * p.overlap, S(stiffness), p.radius};
  }
};"""
    law = collide.granular_contact(collide.Law("stiff", {"stiffness": 500.0}, code))
    sim = collide.Simulation(collide.Mesh(SQUARE.astype(float), TRIANGLES), [law])
    sim.set(numpy.array([[0, 0, 0.0]]) + 0.099, 0.1, numpy.zeros((1, 3)))
    sim.step(1e-6)
    mass = 1000 * 4 / 3 * numpy.pi * 0.1**3
    assert numpy.isclose(sim["velocity"][0, 2], 500 * 0.001 / mass * 1e-6, rtol=1e-6)


@pytest.mark.parametrize("call, error, text", [
    (lambda: collide.granular_contact("hertz"), TypeError, "normal: expected a law"),
    (lambda: collide.granular_contact(collide.gravity()), TypeError, "normal: expected a law"),
    (lambda: collide.granular_contact(granular.mindlin(), granular.hertz()), ValueError, "normal: mindlin is no law of this part, but of tangential"),
    (lambda: collide.granular_contact(granular.none()), ValueError, "normal: none is no law of this part"),
    (lambda: granular.materials(granular.Solid("soft"), granular.SurfacePair()), TypeError, "solids: expected numbers"),
    (lambda: granular.marshall(granular.mindlin()), ValueError, "rolling: mindlin is no law of this part, but of tangential"),
    (lambda: granular.torsion(1), TypeError, r"rolling: expected a law such as collide\.granular\.epsd\(\), got 1"),
    (lambda: granular.mindlin(damping="some"), ValueError, "damping: is 'some', expected 'none', 'of_tangent' or 'of_normal'"),
    (lambda: granular.mindlin(test=1), ValueError, "test: is 1, expected 'spring'"),
    (lambda: granular.materials([granular.Solid()] * 2, {(0, 0): granular.SurfacePair()}), ValueError, r"pairs: .*\(0, 1\)"),
    (lambda: collide.granular_contact(granular.linear(), materials=[1, 2]), ValueError, "materials: expected"),
    (lambda: granular.linear(stiffness=(1, 2)), ValueError, "stiffness: expected a number"),
])
def test_bad_arguments_are_named(call, error, text):
    with pytest.raises(error, match=text):
        call()
