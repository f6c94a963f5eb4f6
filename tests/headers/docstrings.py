"""A docstring is true alone: none begins with a word that refers to what stands before it. And none begins with "What" or
"Whether", here or in tests, benchmarks and examples: it says what it is.

Usage: docstrings.py check | self-test
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = ROOT / "include"
REFERS = re.compile(r"(The same|The other|The others|Then|Both|And|Also|Likewise|Ditto|As above|As before|Otherwise|These|Those"
                    r"|They|It)\b")
ASKS = re.compile(r"(What|Whether)\b")
REFERS_AFTER_CODE = re.compile(r"(the same|then|both|and|also|likewise|ditto|as above|as before)\b", re.IGNORECASE)


def docstrings(text):
    """The line and the beginning of each docstring, and whether it stands after code."""
    inside = False
    for number, line in enumerate(text.splitlines(), 1):
        head = re.match(r"\s*///(?!<)\s?(.*)", line)
        if head and head[1] == "\\file":
            continue
        if head and not inside:
            yield number, head[1], False
        inside = bool(head)
        after = re.search(r"\S.*///<\s?(.*)", line)  # alone in a line it goes on with the one before
        if after:
            yield number, after[1], True


def python_docstrings(text):
    """The line and the beginning of each string in three quotes that begins a line."""
    for number, line in enumerate(text.splitlines(), 1):
        head = re.match(r'\s*"""(.+)', line)
        if head:
            yield number, head[1]


def problems_anywhere(name, text):
    for number, beginning in [*((n, b) for n, b, _ in docstrings(text)), *python_docstrings(text)]:
        asks = ASKS.match(beginning)
        if asks:
            yield f"{name}:{number}: a docstring begins with '{asks[0]}': say what it is"


def problems(name, text):
    yield from problems_anywhere(name, text)
    for number, beginning, after_code in docstrings(text):
        refers = (REFERS_AFTER_CODE if after_code else REFERS).match(beginning)
        if refers:
            yield f"{name}:{number}: a docstring begins with '{refers[0]}': say what it is about"


def self_test():
    """Beginnings that refer to something else are found, and no others."""
    sound = ["/// The radius.\n/// The same line goes on.\nint r;", "int r;  ///< the radius", "/// Then_some.\nint r;",
             "// Then, in code.", "/// Iterators.\nint r;",
             "int r;  ///< the radius of the sphere,\n        ///< and nothing else"]
    faulty = ["/// The same, for doubles.\nint r;", "int a;\n\n  /// Both.\nint r;", "int r;  ///< and its end",
              "int r;  ///< the same", "/// Then.", "/// It is the radius.\nint r;", "/// What a sphere is.\nint r;",
              "/// \\file\n/// Whether spheres touch.\n", 'def f():\n    """What f is."""\n']
    for text in sound:
        yield from (f"found in sound text: {problem}" for problem in problems(repr(text), text))
    for text in faulty:
        if not list(problems("", text)):
            yield f"not found: {text!r}"


def check():
    for path in sorted([*INCLUDE.rglob("*.hpp"), *INCLUDE.rglob("*.cuh")]):
        yield from problems(path.relative_to(INCLUDE).as_posix(), path.read_text())
    for folder in ("tests", "bench", "examples"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".hpp", ".cpp", ".cuh", ".cu", ".py") or path in (ROOT / "bench/report", ROOT / "bench/verification"):
                yield from problems_anywhere(path.relative_to(ROOT).as_posix(), path.read_text())


if __name__ == "__main__":
    found = list({"check": check, "self-test": self_test}[sys.argv[1]]())
    print("\n".join(found) or "fine")
    sys.exit(bool(found))
