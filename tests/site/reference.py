"""reference.py DOXYGEN check|self-test: every public name has a docstring.

check      Doxygen has nothing to complain of.
self-test  It complains where a docstring is missing, or speaks of a parameter that does not exist.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Faults: the header, the text that is changed, its replacement, and the word in Doxygen's complaint.
FAULTS = [
    ("effects/drag.hpp", "  ///< per time, not negative", "", "Member linear"),
    ("sinks/count.hpp", "  /// How many pairs collide; 0 before the first query.\n", "", "Member total"),
    ("sinks/detail/array_in_space.hpp", "  /// True if all of them are stored.\n", "", "Member complete"),
    ("simulation.cuh", "  void step(S dt) {", "  void other() {}\n  void step(S dt) {", "Member step("),
    ("detector.hpp", "\\param sink     where", "\\param sinc     where", "argument 'sinc'"),
]


def complaints(doxygen, root):
    with tempfile.TemporaryDirectory() as out:
        run = subprocess.run([doxygen, "docs/Doxyfile"], cwd=root, env={**os.environ, "COLLIDE_XML": out}, text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return run.stdout if run.returncode or run.stdout else ""


def self_test(doxygen):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        shutil.copytree(ROOT / "include", root / "include")
        shutil.copytree(ROOT / "docs", root / "docs", ignore=shutil.ignore_patterns("images"))
        for name, sound, faulty, expected in FAULTS:
            header = root / "include" / "collide" / name
            text = header.read_text()
            if sound not in text:
                yield f"{name} has no {sound!r}: choose another fault"
            header.write_text(text.replace(sound, faulty))
            if expected not in complaints(doxygen, root):
                yield f"not found: {expected} in {name}"
            header.write_text(text)


if __name__ == "__main__":
    if sys.argv[2] == "check":
        found = complaints(sys.argv[1], ROOT).splitlines()
    else:
        found = list(self_test(sys.argv[1]))
    print("\n".join(found) or "fine")
    sys.exit(bool(found))
