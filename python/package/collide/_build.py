"""Compiles a simulation's list of effects with the machine's compiler, once, and keeps it."""

import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

from ._errors import Error
from ._source import BUILT_IN, name_of, source

_HERE = pathlib.Path(__file__).parent


def library(part, effects, space, capability, **options):
    """The path of the library of a part of a list of effects, from the package, from the cache, or compiled now."""
    built_in = _HERE / "lists" / (name_of(source(effects, space, **options)) + ".so")
    if built_in.exists():
        return str(built_in)
    text = source(effects, space, **options, parts=(part,))
    command = _command(space, capability)
    key = "\n".join([text, _version_of(command[0]), *command, _headers()])
    path = cache() / (hashlib.sha256(key.encode()).hexdigest()[:32] + ".so")
    if not path.exists():
        _compile(text, command, path, _names(effects), space, part)
    return str(path)


def _names(effects):
    return ", ".join(effect.name for effect in effects)


def cache():
    """Where compiled lists are kept: COLLIDE_CACHE, else $XDG_CACHE_HOME/collide, else ~/.cache/collide."""
    base = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    return pathlib.Path(os.environ.get("COLLIDE_CACHE") or pathlib.Path(base) / "collide")


def _command(space, capability):
    """Compiler and flags, without the files."""
    flags = ["-std=c++17", "-O2", "-shared", f"-I{_HERE / 'include'}", f"-I{_HERE / 'src'}"]
    if space == "host":
        compiler = _find("CXX", ("g++", "clang++", "c++"))
        compiled = ["-DCOLLIDE_COMPILED", "-Wl,--no-as-needed", str(_HERE / "libcollide_python.so")]
        hoards = "--param=ggc-min-heapsize=2000000"  # g++ takes 400 MB; to collect some would take a twentieth of the time
        return [*compiler, *flags, "-fPIC", "-fvisibility=hidden", "-ffp-contract=off", "-fopenmp", hoards, *compiled]
    compiler = _find("CUDACXX", ("nvcc", "/usr/local/cuda/bin/nvcc"))
    host = "-Xcompiler=-fPIC,-fvisibility=hidden,-ffp-contract=off,-fopenmp"
    cuda = ["--expt-relaxed-constexpr", "--diag-suppress=20012", "-fmad=false", "-cudart=static", f"-arch=sm_{capability}"]
    return [*compiler, *flags, *cuda, host]


def _find(variable, names):
    given = shlex.split(os.environ.get(variable, ""))
    for name in [given[0]] if given else names:
        if path := shutil.which(name):
            return [path, *given[1:]]
    lists = "\n".join("  " + _names(effects) for effects in BUILT_IN)
    raise Error(
        f"collide: this list of effects is not in the package, and there is no compiler for it ({' or '.join(names)}; "
        f"the environment variable {variable} may name one). Without one there are, exact, of float32 and for grains float64:\n{lists}"
    )


def _version_of(compiler):
    return subprocess.run([compiler, "--version"], capture_output=True, text=True, check=False).stdout


def _headers():
    """What is in the headers, as one number."""
    digest = hashlib.sha256()
    for path in sorted(_HERE.rglob("*")):
        if path.suffix in (".hpp", ".cuh"):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _compile(text, command, path, names, space, part):
    path.parent.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    tool = os.path.basename(command[0])
    what = {"simulation": "a simulation", "bookkeeping": "energy, contact_report, save and load"}[part]
    print(f"collide: {tool} compiles {what} of {names} ...", end="", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        file = pathlib.Path(folder) / ("simulation.cpp" if space == "host" else "simulation.cu")
        file.write_text(text)
        made = pathlib.Path(folder) / "simulation.so"
        done = subprocess.run([*command, str(file), "-o", str(made)], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            print(" failed", file=sys.stderr)
            if sentence := re.search(r"static assertion failed: collide: ([^\n]*)", done.stderr):
                raise Error(f"collide: the effects {names}: {sentence[1]}")
            raise Error(f"collide: {tool} does not compile this simulation:\n{_what_matters(done.stderr, text)}")
        os.replace(made, path)  # another process may have been as fast: the same file
    print(f" {time.monotonic() - began:.0f} s, kept in {path.parent}", file=sys.stderr)


def _what_matters(errors, text):
    """Errors in the code of the user, each with the line that it is in, and the sentences of the library; where there
    are none, the first lines."""
    lines, found = errors.splitlines(), []
    for line in lines:
        where = re.match(r"((?:effect|law) \w+)[:(](\d+)", line)
        if where and ("error" in line or "required from" in line):
            code = text.partition(f'#line 1 "{where[1]}"\n')[2].splitlines()
            found += [line, *code[int(where[2]) - 1 : int(where[2])]]
        elif "error" in line and "collide:" in line:
            found.append(line)
    return "\n".join(dict.fromkeys(found[:40] or lines[:40]))
