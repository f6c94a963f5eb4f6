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
    "periodic_box": ((0,) * 3, (1,) * 3),
}
THREE = granular.materials([granular.Solid()] * 3, granular.SurfacePair())
GRANULAR = [
    collide.granular_contact(granular.linear(), granular.dashpot(), granular.constant_torque(), granular.sjkr()),
    collide.granular_contact(granular.hertz(), granular.mindlin(), granular.epsd(), granular.jkr(), materials=THREE),
    collide.granular_contact(granular.hertz(), granular.mindlin_rescale(), cohesion=granular.dmt()),
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
    """But reaction and mass_flow, which need sums that a program reads."""
    every = [getattr(effects, name)(*REQUIRED.get(name, ())) for name in effects.__all__] + GRANULAR
    headers = {path.relative_to(HERE / "include").as_posix() for path in (HERE / "include/collide/effects").rglob("*.hpp")}
    named = {word for effect in every for word in effect.code.replace("<", " ").replace(">", " ").split() if "/" in word}
    others = {"reaction", "mass_flow", "granular/materials"}
    assert headers - named == {f"collide/effects/{name}.hpp" for name in others}


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
    assert "angular_velocity" in sim.columns and 0 < dt < 1e-3
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
    (lambda: granular.mindlin(damping="some"), ValueError, "damping: is 'some', expected 'none' or 'of_tangent'"),
    (lambda: granular.mindlin(test=1), ValueError, "test: is 1, expected 'spring'"),
    (lambda: granular.materials([granular.Solid()] * 2, {(0, 0): granular.SurfacePair()}), ValueError, r"pairs: .*\(0, 1\)"),
    (lambda: collide.granular_contact(granular.linear(), materials=[1, 2]), ValueError, "materials: expected"),
    (lambda: granular.linear(stiffness=(1, 2)), ValueError, "stiffness: expected a number"),
])
def test_bad_arguments_are_named(call, error, text):
    with pytest.raises(error, match=text):
        call()
