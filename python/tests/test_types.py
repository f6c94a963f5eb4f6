"""Types: mypy and pyright (or basedpyright, which needs no network) on a program that uses all, as far as they are there."""

import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys

import numpy
import pytest

import collide

PROGRAM = pathlib.Path(__file__).parent / "typed_program.py"
WRONG = {
    "collide.Mesh(vertices).query(points, 0.5).offsets": "offsets",
    "collide.Mesh(vertices).query(points, 0.5, order='sorted')": "order|overload",
    "collide.bounce(restitution='high')": "str|high|first",
    "collide.no_such_effect()": "no_such_effect",
    "sim.sums('mass_flow').linear": "linear",
    "collide.Body('first', 2)": "str|high|first",
}


def check(tool, path, *options):
    if importlib.util.find_spec(tool) is None:
        pytest.skip(f"there is no {tool}")
    here = os.path.abspath(pathlib.Path(collide.__file__).parents[1])
    options_of_pyright = {"typeCheckingMode": "standard", "extraPaths": [here, str(pathlib.Path(numpy.__file__).parents[1])]}
    (path.parent / "pyrightconfig.json").write_text(json.dumps(options_of_pyright))
    command = [sys.executable, "-m", tool, *options, str(path)]
    environment = {**os.environ, "MYPY_CACHE_DIR": os.devnull, "MYPYPATH": here if "site-packages" not in here else ""}
    return subprocess.run(command, capture_output=True, text=True, env=environment, cwd=path.parent)


TOOLS = pytest.mark.parametrize("tool", [("mypy", "--strict"), ("basedpyright", "--level", "error")])


@TOOLS
def test_a_program_that_uses_all_has_no_errors(tool, tmp_path):
    (tmp_path / "program.py").write_text(PROGRAM.read_text())
    done = check(tool[0], tmp_path / "program.py", *tool[1:])
    assert done.returncode == 0, done.stdout + done.stderr


@TOOLS
def test_wrong_programs_have(tool, tmp_path):
    """Each of these lines, so that what passes says something."""
    head = PROGRAM.read_text() + "\n"
    (tmp_path / "program.py").write_text(head + "\n".join(WRONG) + "\n")
    printed = check(tool[0], tmp_path / "program.py", *tool[1:]).stdout
    for number, (line, text) in enumerate(WRONG.items(), head.count("\n") + 1):
        found = [one for one in printed.splitlines() if re.search(rf"program\.py:{number}[:-]", one)]
        assert found and re.search(text, printed[printed.index(found[0]) :]), (line, printed)


def test_the_program_runs():
    done = subprocess.run([sys.executable, PROGRAM], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[:2] == ["5 of 10", "10 of 10"]
