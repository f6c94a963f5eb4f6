"""Each script that a workflow of .github/workflows/ runs is there, with the arguments that its help names."""
import os
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def problems():
    files = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
    if len(files) < 4:
        yield "workflows are missing"
    ran = 0
    for path in files:
        for line in path.read_text().splitlines():
            for script, arguments in re.findall(r"^\s*(?:- )?run: ((?:scripts|\.ci)/[\w-]+)(.*)$", line):
                ran += 1
                if not os.access(ROOT / script, os.X_OK):
                    yield f"{path.name}: there is no script {script}"
                    continue
                text = (ROOT / script).read_text()
                yield from (f"{path.name}: {script} does not know {a}" for a in arguments.split() if re.fullmatch(r"--\w+|[a-z]+", a)
                            and a not in text and "FOLDER" not in text)
    if ran < 4:
        yield f"workflows run only {ran} scripts"


if __name__ == "__main__":
    found = list(problems())
    print("\n".join(found) or "fine")
    sys.exit(bool(found))
