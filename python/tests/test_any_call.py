"""Random calls with random arguments, in a process of their own: see any_call.py. COLLIDE_HUNT_SECONDS says for how long,
COLLIDE_HUNT_SEED from where."""

import os
import pathlib
import subprocess
import sys


def test_no_call_crashes_or_hangs(tmp_path):
    seconds, seed = os.environ.get("COLLIDE_HUNT_SECONDS", "30"), os.environ.get("COLLIDE_HUNT_SEED", "1")
    command = [sys.executable, "-B", pathlib.Path(__file__).parent / "any_call.py", seconds, seed, tmp_path / "log"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=2 * float(seconds) + 600)
    last = (tmp_path / "log").read_text() if (tmp_path / "log").exists() else ""
    assert done.returncode == 0, f"{done.stdout}{done.stderr}\nthe last call: {last}"
    assert int(done.stdout.split()[0]) > 5  # examples
