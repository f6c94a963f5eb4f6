"""All files that name a version name that of include/collide/core/version.hpp."""
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent

header = (ROOT / "include" / "collide" / "core" / "version.hpp").read_text()
version = ".".join(re.findall(r"^#define COLLIDE_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)$", header, re.M))
said = {
    "CITATION.cff": re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(), re.M)[1],
    "packaging/vcpkg/collide/vcpkg.json": json.loads((ROOT / "packaging/vcpkg/collide/vcpkg.json").read_text())["version"],
    "CHANGELOG.md": re.search(r"^## \[(\d\S*)\]", (ROOT / "CHANGELOG.md").read_text(), re.M)[1],  # the newest
}
for other in re.findall(r"libcollide-dev_([0-9.]+)_all", (ROOT / "README.md").read_text()):
    if other != version:
        said["README.md"] = other
wrong = {name: other for name, other in said.items() if other != version}
for name, other in wrong.items():
    print(f"{name} says {other}, include/collide/core/version.hpp {version}")
sys.exit(bool(wrong))
